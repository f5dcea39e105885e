//! Gains and biases of actuators, force = gain · input + bias, and the derivatives of the force by velocity and length.

use super::actuator::{ActuatorInputs, ActuatorMotion};
use crate::dynamics::activation::{acting, input};
use crate::dynamics::muscle::Muscle;
use crate::dynamics::{dc_motor, pid};
use crate::model::{BiasKind, GainKind, Model, Params};
use clench_math::Real;

/// Computes the force of actuator `u` before its limit, without the parts that are not limited (a motor's cogging and
/// friction).
#[inline(always)]
pub(crate) fn unlimited_force<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let affine = |prm: &[T; 10]| prm[0] + prm[1] * at.length + prm[2] * at.velocity;
    let input = || input(model, params, inputs, act_dot, u, at);
    let (gainprm, biasprm) = (&params.actuator_gainprm[u], &params.actuator_biasprm[u]);
    let (gain, input) = match model.actuators[u].gain {
        GainKind::Fixed => (gainprm[0], input()),
        GainKind::Affine => (affine(gainprm), input()),
        GainKind::Muscle => {
            let muscle = Muscle::new(params, u, gainprm, at.length);
            (muscle.gain(at.velocity), input())
        }
        GainKind::DcMotor => {
            let (gain, voltage) = dc_motor::gain_and_voltage(model, params, inputs, u, at);
            let current = model.actuators[u].states.current;
            let current = current.map(|a| acting(model, params, inputs, act_dot, (u, a), at));
            (gain, current.unwrap_or(voltage))
        }
        GainKind::Pid => (T::ONE, pid::force(model, params, inputs, act_dot, u, at)),
        GainKind::User => (T::ONE, input()),
        GainKind::So3 => (T::ZERO, T::ZERO), // Has a torque of three parts, see `orientation`.
    };
    let active = gain * input;
    match model.actuators[u].bias {
        BiasKind::None | BiasKind::So3 | BiasKind::User => active,
        BiasKind::Affine => active + affine(biasprm),
        BiasKind::Muscle => active + Muscle::new(params, u, biasprm, at.length).bias(),
        BiasKind::DcMotor => active - dc_motor::back_emf(model, params, u, gain, at),
    }
}

/// Computes ∂force/∂velocity of [`unlimited_force`].
#[inline(always)]
pub(crate) fn unlimited_slope<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let gainprm = &params.actuator_gainprm[u];
    let input = || input(model, params, inputs, act_dot, u, at);
    let by_gain = match model.actuators[u].gain {
        GainKind::Fixed | GainKind::Pid | GainKind::So3 | GainKind::User => T::ZERO,
        GainKind::Affine => gainprm[2] * input(),
        GainKind::Muscle => {
            Muscle::new(params, u, gainprm, at.length).gain_slope(at.velocity) * input()
        }
        GainKind::DcMotor => dc_motor::electrical_slope(model, params, inputs, act_dot, u, at),
    };
    match model.actuators[u].bias {
        BiasKind::Affine => params.actuator_biasprm[u][2] + by_gain,
        BiasKind::None | BiasKind::Muscle | BiasKind::DcMotor | BiasKind::So3 | BiasKind::User => {
            by_gain
        }
    }
}

/// Computes ∂force/∂length of [`unlimited_force`].
#[inline(always)]
pub(crate) fn unlimited_length_slope<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let (gainprm, biasprm) = (&params.actuator_gainprm[u], &params.actuator_biasprm[u]);
    let input = || input(model, params, inputs, act_dot, u, at);
    let by_gain = match model.actuators[u].gain {
        GainKind::Fixed | GainKind::Pid | GainKind::So3 | GainKind::User => T::ZERO,
        GainKind::Affine => gainprm[1] * input(),
        GainKind::Muscle => {
            let muscle = Muscle::new(params, u, gainprm, at.length);
            muscle.gain_length_slope(at.velocity) * input()
        }
        GainKind::DcMotor => {
            dc_motor::electrical_length_slope(model, params, inputs, act_dot, u, at)
        }
    };
    match model.actuators[u].bias {
        BiasKind::Affine => biasprm[1] + by_gain,
        BiasKind::Muscle => by_gain + Muscle::new(params, u, biasprm, at.length).bias_slope(),
        BiasKind::None | BiasKind::DcMotor | BiasKind::So3 | BiasKind::User => by_gain,
    }
}
