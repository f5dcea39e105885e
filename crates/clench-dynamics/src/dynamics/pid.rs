//! PID controllers: force = kp (position setpoint − length) + kv (velocity setpoint − velocity) + ki ∫error +
//! feedforward.
//!
//! As in MuJoCo, kp and kv are those of the affine bias, which provides the part of the force without setpoints. ki is
//! `gainprm[0]`, the bound of the integral `dynprm[0]`, the maximum rate of the position setpoint `dynprm[1]`.

use super::activation::acting;
use super::actuator::{ActuatorContext, ActuatorInputs};
use super::setpoint::{Setpoints, integral_rate, nearest_setpoint};
use clench_math::Real;

/// Computes the rates of the activations of an actuator.
#[inline(always)]
pub(crate) fn activation_rates<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &mut [T],
) {
    let states = at.actuator().states;
    let setpoints = Setpoints::new(at, inputs);
    if let Some(a) = states.slew {
        act_dot[a] = setpoints.slew_rate(at.params, inputs.act[a]);
    }
    if let Some(a) = states.integral {
        let target = nearest_setpoint(at, setpoints.position, at.length);
        let limit = at.dynprm()[0];
        act_dot[a] = integral_rate(target - at.length, inputs.act[a], limit);
    }
}

/// Computes the part of the force due to setpoints and the integral.
#[inline(always)]
pub(crate) fn force<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let setpoints = Setpoints::new(at, inputs);
    let target = nearest_setpoint(at, setpoints.position, at.length);
    let bias = at.biasprm();
    let force = setpoints.feedforward - bias[1] * target - bias[2] * setpoints.velocity;
    match at.actuator().states.integral {
        Some(a) => force + at.gainprm()[0] * acting(at, inputs, act_dot, a),
        None => force,
    }
}
