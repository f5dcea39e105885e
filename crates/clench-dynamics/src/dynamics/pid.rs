//! PID controllers: force = kp (position setpoint − length) + kv (velocity setpoint − velocity) + ki ∫error +
//! feedforward.
//!
//! As in MuJoCo, kp and kv are those of the affine bias, which provides the part of the force without setpoints. ki is
//! `gainprm[0]`, the bound of the integral `dynprm[0]`, the maximum rate of the position setpoint `dynprm[1]`.

use super::actuator::{ActuatorInputs, ActuatorMotion};
use super::setpoint::nearest_setpoint;
use crate::dynamics::activation::next_activation;
use crate::dynamics::setpoint::{Setpoints, integral_rate};
use crate::model::{Model, Params};
use clench_math::Real;

/// Computes the rates of the activations of actuator `u`.
#[inline(always)]
pub(crate) fn activation_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    u: usize,
    length: T,
    act_dot: &mut [T],
) {
    let states = model.actuators[u].states;
    let setpoints = Setpoints::new(model, params, inputs, u);
    if let Some(a) = states.slew {
        act_dot[a] = setpoints.slew_rate(params, inputs.act[a]);
    }
    if let Some(a) = states.integral {
        let target = nearest_setpoint(model, params, u, setpoints.position, length);
        let limit = params.actuator_dynprm[u][0];
        act_dot[a] = integral_rate(target - length, inputs.act[a], limit);
    }
}

/// Computes the part of the force due to setpoints and the integral.
#[inline(always)]
pub(crate) fn force<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let actuator = &model.actuators[u];
    let setpoints = Setpoints::new(model, params, inputs, u);
    let target = nearest_setpoint(model, params, u, setpoints.position, at.length);
    let bias = &params.actuator_biasprm[u];
    let force = setpoints.feedforward - bias[1] * target - bias[2] * setpoints.velocity;
    let Some(a) = actuator.states.integral else {
        return force;
    };
    let integral = if actuator.actearly {
        next_activation(
            model,
            params,
            u,
            a,
            (inputs.act[a], act_dot[a]),
            at.velocity,
        )
    } else {
        inputs.act[a]
    };
    force + params.actuator_gainprm[u][0] * integral
}
