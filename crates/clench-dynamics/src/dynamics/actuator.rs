//! What actuators are given, and how they move.

use crate::model::Model;
use crate::stages::{Positions, Velocities};
use clench_math::{Real, Scalar};

/// What actuators are given: controls as they act, and activations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorInputs<'a, T> {
    /// Delayed, and within their ranges (nu).
    pub ctrl: &'a [T],
    /// Activations (na).
    pub act: &'a [T],
}

/// Length and velocity of an actuator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorMotion<T> {
    /// Length of its transmission.
    pub length: T,
    /// Velocity of its transmission.
    pub velocity: T,
}

impl<T: Real> ActuatorMotion<T> {
    /// Of actuator `u`, the first where it has several.
    #[inline(always)]
    pub(crate) fn of(model: &Model, pos: &Positions<T>, vel: &Velocities<T>, u: usize) -> Self {
        let output = model.actuators[u].outputs.start;
        ActuatorMotion {
            length: pos.actuator_length[output],
            velocity: vel.actuator_velocity[output],
        }
    }
}

/// The share by which a force that was scaled to the end of a range may miss it.
#[inline(always)]
pub(super) fn scaling_error<T: Real>() -> T {
    T::new(SUM_ROUNDING).max(T::splat(T::Scalar::EPSILON) * T::new(16.0))
}

/// A sum of scaled forces is at the end of a range if it misses it by so little of it (as in MuJoCo), or by rounding.
pub(super) const SUM_ROUNDING: f64 = 1e-10;
