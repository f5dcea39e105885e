//! Gains and biases of actuators, force = gain · input + bias, and how the force changes with velocity.

use crate::dynamics::muscle::Muscle;
use crate::model::{BiasKind, GainKind, Model, Params};
use crate::workspace::{Positions, Velocities};
use clench_math::Real;

/// Length and velocity of an actuator.
#[derive(Clone, Copy, Debug)]
pub struct ActuatorMotion<T> {
    /// Length of its transmission.
    pub length: T,
    /// Velocity of its transmission.
    pub velocity: T,
}

impl<T: Real> ActuatorMotion<T> {
    /// Of actuator `u`.
    #[inline(always)]
    pub fn of(pos: &Positions<T>, vel: &Velocities<T>, u: usize) -> Self {
        ActuatorMotion {
            length: pos.actuator_length[u],
            velocity: vel.actuator_velocity[u],
        }
    }
}

/// The force of actuator `u` before any limit.
#[inline(always)]
pub fn unlimited_force<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    input: T,
    at: ActuatorMotion<T>,
) -> T {
    let affine = |prm: &[T; 10]| prm[0] + prm[1] * at.length + prm[2] * at.velocity;
    let (gainprm, biasprm) = (&params.actuator_gainprm[u], &params.actuator_biasprm[u]);
    let gain = match model.actuators[u].gain {
        GainKind::Fixed => gainprm[0],
        GainKind::Affine => affine(gainprm),
        GainKind::Muscle => Muscle::new(params, u, gainprm, at.length).gain(at.velocity),
        GainKind::User => T::ONE,
    };
    match model.actuators[u].bias {
        BiasKind::None | BiasKind::User => gain * input,
        BiasKind::Affine => gain * input + affine(biasprm),
        BiasKind::Muscle => gain * input + Muscle::new(params, u, biasprm, at.length).bias(),
    }
}

/// ∂force/∂velocity of actuator `u` before any limit; `input` is only asked for where the gain depends on velocity.
#[inline(always)]
pub fn force_slope<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    input: impl Fn() -> T,
    at: ActuatorMotion<T>,
) -> T {
    let gainprm = &params.actuator_gainprm[u];
    let by_gain = match model.actuators[u].gain {
        GainKind::Fixed | GainKind::User => T::ZERO,
        GainKind::Affine => gainprm[2] * input(),
        GainKind::Muscle => {
            Muscle::new(params, u, gainprm, at.length).gain_slope(at.velocity) * input()
        }
    };
    match model.actuators[u].bias {
        BiasKind::Affine => params.actuator_biasprm[u][2] + by_gain,
        BiasKind::None | BiasKind::Muscle | BiasKind::User => by_gain,
    }
}
