//! Gains and biases of actuators, force = gain · input + bias, and the derivatives of the force by velocity and length.

use super::actuator::{ActuatorContext, ActuatorInputs};
use crate::dynamics::activation::{acting, input};
use crate::dynamics::muscle::Muscle;
use crate::dynamics::{dc_motor, pid};
use crate::model::{BiasKind, GainKind};
use clench_math::Real;

/// Computes the force of an actuator before its limit, without the parts that are not limited (a motor's cogging and
/// friction).
#[inline(always)]
pub(crate) fn unlimited_force<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let affine = |prm: &[T; 10]| prm[0] + prm[1] * at.length + prm[2] * at.velocity;
    let input = || input(at, inputs, act_dot);
    let (gainprm, biasprm) = (at.gainprm(), at.biasprm());
    let (gain, input) = match at.actuator().gain {
        GainKind::Fixed => (gainprm[0], input()),
        GainKind::Affine => (affine(gainprm), input()),
        GainKind::Muscle => {
            let muscle = Muscle::new(at, gainprm);
            (muscle.gain(at.velocity), input())
        }
        GainKind::DcMotor => {
            let (gain, voltage) = dc_motor::gain_and_voltage(at, inputs);
            let current = at.actuator().states.current;
            let current = current.map(|a| acting(at, inputs, act_dot, a));
            (gain, current.unwrap_or(voltage))
        }
        GainKind::Pid => (T::ONE, pid::force(at, inputs, act_dot)),
        GainKind::User => (T::ONE, input()),
        GainKind::So3 => (T::ZERO, T::ZERO), // Has a torque of three parts, see `orientation`.
    };
    let active = gain * input;
    match at.actuator().bias {
        BiasKind::None | BiasKind::So3 | BiasKind::User => active,
        BiasKind::Affine => active + affine(biasprm),
        BiasKind::Muscle => active + Muscle::new(at, biasprm).bias(),
        BiasKind::DcMotor => active - dc_motor::back_emf(at, gain),
    }
}

/// Computes ∂force/∂velocity of [`unlimited_force`].
#[inline(always)]
pub(crate) fn unlimited_slope<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let gainprm = at.gainprm();
    let input = || input(at, inputs, act_dot);
    let by_gain = match at.actuator().gain {
        GainKind::Fixed | GainKind::Pid | GainKind::So3 | GainKind::User => T::ZERO,
        GainKind::Affine => gainprm[2] * input(),
        GainKind::Muscle => Muscle::new(at, gainprm).gain_slope(at.velocity) * input(),
        GainKind::DcMotor => dc_motor::electrical_slope(at, inputs, act_dot),
    };
    match at.actuator().bias {
        BiasKind::Affine => at.biasprm()[2] + by_gain,
        BiasKind::None | BiasKind::Muscle | BiasKind::DcMotor | BiasKind::So3 | BiasKind::User => {
            by_gain
        }
    }
}

/// Computes ∂force/∂length of [`unlimited_force`].
#[inline(always)]
pub(crate) fn unlimited_length_slope<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let (gainprm, biasprm) = (at.gainprm(), at.biasprm());
    let input = || input(at, inputs, act_dot);
    let by_gain = match at.actuator().gain {
        GainKind::Fixed | GainKind::Pid | GainKind::So3 | GainKind::User => T::ZERO,
        GainKind::Affine => gainprm[1] * input(),
        GainKind::Muscle => {
            let muscle = Muscle::new(at, gainprm);
            muscle.gain_length_slope(at.velocity) * input()
        }
        GainKind::DcMotor => dc_motor::electrical_length_slope(at, inputs, act_dot),
    };
    match at.actuator().bias {
        BiasKind::Affine => biasprm[1] + by_gain,
        BiasKind::Muscle => by_gain + Muscle::new(at, biasprm).bias_slope(),
        BiasKind::None | BiasKind::DcMotor | BiasKind::So3 | BiasKind::User => by_gain,
    }
}
