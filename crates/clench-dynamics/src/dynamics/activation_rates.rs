//! Activation dynamics: the rates of change of activations.

use super::activation::time_constant;
use super::actuator::{ActuatorContext, ActuatorInputs};
use super::setpoint::nearest_setpoint;
use super::{dc_motor, muscle, pid};
use crate::model::{DynamicsKind, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Real, kernel};

/// Computes the rate of change of each activation (na). A filtered servo on a circle turns towards its control along
/// the shorter arc.
#[kernel]
pub(crate) fn activation_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    act_dot: &mut [T],
) {
    for (u, actuator) in model.actuators.iter().enumerate() {
        let Some(a) = actuator.act() else { continue };
        let act = inputs.act[a];
        let ctrl = || inputs.ctrl[actuator.controls.start];
        let at = ActuatorContext::new(model, params, (pos, vel), u);
        act_dot[a] = match actuator.dynamics {
            // MuJoCo leaves these rates to a user callback.
            DynamicsKind::None | DynamicsKind::User => T::ZERO,
            DynamicsKind::Muscle => muscle::activation_rate(ctrl(), act, at.dynprm()),
            DynamicsKind::Integrator => {
                let controls = &inputs.ctrl[actuator.controls.clone()];
                for (a, &rate) in actuator.acts.clone().zip(controls) {
                    act_dot[a] = rate;
                }
                continue;
            }
            DynamicsKind::Filter | DynamicsKind::FilterExact => {
                (nearest_setpoint(at, ctrl(), act) - act) / time_constant(at)
            }
            DynamicsKind::Pid => {
                pid::activation_rates(at, inputs, act_dot);
                continue;
            }
            DynamicsKind::DcMotor => {
                dc_motor::activation_rates(at, inputs, act_dot);
                continue;
            }
        };
    }
}
