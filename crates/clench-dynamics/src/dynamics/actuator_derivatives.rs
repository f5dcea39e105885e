//! The derivatives of an actuator's force by its velocity and length, after all limits; zero if a limit of the
//! actuator, its tendon or its joint is reached.

use super::actuator::{ActuatorContext, ActuatorInputs, scaling_error};
use crate::dynamics::actuation::limited_tendon;
use crate::dynamics::gain::{unlimited_force, unlimited_length_slope, unlimited_slope};
use crate::dynamics::{dc_motor, orientation};
use crate::model::{BiasKind, GainKind, Model, Params};
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Mask, Real, kernel};

/// Computes ∂force/∂velocity of actuator `u`.
#[kernel]
pub(crate) fn velocity_derivative<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    u: usize,
) -> T {
    let actuator = &model.actuators[u];
    if actuator.disabled {
        return T::ZERO;
    }
    if actuator.gain.is_rotation() {
        return orientation::slope(model, params, u, &force.actuator_force);
    }
    let at = ActuatorContext::new(model, params, (pos, vel), u);
    let inputs = inputs(state, force);
    let slope = unlimited_slope(at, inputs, &force.act_dot);
    let at_limit = is_at_limit(at, inputs, force);
    // As in MuJoCo, friction counts here with a motor's gain, though it is part of its bias.
    let friction = || dc_motor::mechanical_slope(at);
    let slope = match (actuator.gain, actuator.bias) {
        // The bias of a motor requires its gain. No limit applies to it.
        (GainKind::DcMotor, BiasKind::DcMotor) => T::select(at_limit, T::ZERO, slope) + friction(),
        (GainKind::DcMotor, _) => T::select(at_limit, T::ZERO, slope + friction()),
        _ => T::select(at_limit, T::ZERO, slope),
    };
    unless_joint_limits(at, force, slope)
}

/// Computes ∂force/∂length of actuator `u`. For an orientation servo, that at small angles, equal about each axis.
#[kernel]
pub(crate) fn length_derivative<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    u: usize,
) -> T {
    let actuator = &model.actuators[u];
    if actuator.disabled {
        return T::ZERO;
    }
    if actuator.gain.is_rotation() {
        return orientation::length_slope(model, params, u, &force.actuator_force);
    }
    let at = ActuatorContext::new(model, params, (pos, vel), u);
    let inputs = inputs(state, force);
    let slope = unlimited_length_slope(at, inputs, &force.act_dot);
    let at_limit = is_at_limit(at, inputs, force);
    let slope = T::select(at_limit, T::ZERO, slope);
    let slope = match actuator.bias {
        BiasKind::DcMotor => slope + dc_motor::cogging_slope(at),
        BiasKind::None | BiasKind::Affine | BiasKind::Muscle | BiasKind::So3 | BiasKind::User => {
            slope
        }
    };
    unless_joint_limits(at, force, slope)
}

#[inline(always)]
fn inputs<'a, T: Real>(state: &'a State<T>, force: &'a Forces<T>) -> ActuatorInputs<'a, T> {
    ActuatorInputs {
        ctrl: &force.ctrl,
        act: &state.act,
    }
}

/// Returns the lanes in which the force is at an end of its range, or the total of its tendon at an end of the tendon's
/// range.
#[inline(always)]
fn is_at_limit<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    force: &Forces<T>,
) -> T::Mask {
    let actuator = at.actuator();
    let mut at_limit = T::Mask::splat(false);
    if actuator.forcelimited {
        // Cogging and friction of a motor follow its limit, which clamps only the current's force.
        let limited = match actuator.bias {
            BiasKind::DcMotor => unlimited_force(at, inputs, &force.act_dot),
            BiasKind::None
            | BiasKind::Affine
            | BiasKind::Muscle
            | BiasKind::So3
            | BiasKind::User => force.actuator_force[actuator.outputs.start],
        };
        at_limit |= is_saturated(limited, at.params.actuator_forcerange[at.u]);
    }
    if let Some(t) = limited_tendon(at.model, actuator.transmission) {
        at_limit |= is_reached(force.ten_actuator_force[t], at.params.tendon_actfrcrange[t]);
    }
    at_limit
}

/// Returns the slope, or zero in lanes in which the range of the actuator's joint clamps the total force.
#[inline(always)]
fn unless_joint_limits<T: Real>(at: ActuatorContext<T>, force: &Forces<T>, slope: T) -> T {
    let (model, joint) = (at.model, at.actuator().transmission.joint());
    match joint.filter(|&j| model.joints[j].actfrclimited) {
        Some(j) => {
            let total = force.qfrc_actuator[model.joints[j].dof];
            let at_limit = is_saturated(total, at.params.jnt_actfrcrange[j]);
            T::select(at_limit, T::ZERO, slope)
        }
        None => slope,
    }
}

#[inline(always)]
fn is_saturated<T: Real>(value: T, [low, high]: [T; 2]) -> T::Mask {
    value.le(low) | value.ge(high)
}

/// Returns the lanes in which a sum of forces scaled into a range is at one of its ends. As in MuJoCo, if actuators
/// reach the range of their tendon and one is then clamped by its own range, the reduced sum is compared.
#[inline(always)]
fn is_reached<T: Real>(sum: T, [low, high]: [T; 2]) -> T::Mask {
    let rounding = scaling_error::<T>();
    sum.le(low + low.abs() * rounding) | sum.ge(high - high.abs() * rounding)
}
