//! Inputs and motion of actuators.

use crate::model::Model;
use crate::stages::{Positions, Velocities};
use clench_math::{Real, Scalar};

/// The inputs of actuators: effective controls, and activations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorInputs<'a, T> {
    /// Controls, delayed and clamped (nu).
    pub ctrl: &'a [T],
    /// Activations (na).
    pub act: &'a [T],
}

/// Length and velocity of an actuator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorMotion<T> {
    /// The length of its transmission.
    pub length: T,
    /// The velocity of its transmission.
    pub velocity: T,
}

impl<T: Real> ActuatorMotion<T> {
    /// Returns the motion of the first output of actuator `u`.
    #[inline(always)]
    pub(crate) fn of(model: &Model, pos: &Positions<T>, vel: &Velocities<T>, u: usize) -> Self {
        let output = model.actuators[u].outputs.start;
        ActuatorMotion {
            length: pos.actuator_length[output],
            velocity: vel.actuator_velocity[output],
        }
    }
}

/// Returns the relative error with which a force scaled to the end of a range may miss it.
#[inline(always)]
pub(super) fn scaling_error<T: Real>() -> T {
    T::new(SUM_ROUNDING).max(T::splat(T::Scalar::EPSILON) * T::new(16.0))
}

/// The relative error within which a sum of scaled forces is at the end of a range (as in MuJoCo).
pub(super) const SUM_ROUNDING: f64 = 1e-10;
