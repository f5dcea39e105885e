//! An actuator and its inputs, which all its formulas read.

use crate::model::{Actuator, Model, Params};
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

/// An actuator at a length and velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorContext<'a, T> {
    pub model: &'a Model,
    pub params: &'a Params<T>,
    /// The index of the actuator.
    pub u: usize,
    /// The length of its transmission; of several, the first.
    pub length: T,
    /// The velocity of its transmission, likewise.
    pub velocity: T,
}

impl<'a, T: Real> ActuatorContext<'a, T> {
    /// Returns actuator `u` at its present length and velocity.
    #[inline(always)]
    pub(crate) fn new(
        model: &'a Model,
        params: &'a Params<T>,
        (pos, vel): (&Positions<T>, &Velocities<T>),
        u: usize,
    ) -> Self {
        let output = model.actuators[u].outputs.start;
        ActuatorContext {
            model,
            params,
            u,
            length: pos.actuator_length[output],
            velocity: vel.actuator_velocity[output],
        }
    }

    /// Returns the actuator.
    #[inline(always)]
    pub(crate) fn actuator(self) -> &'a Actuator {
        &self.model.actuators[self.u]
    }

    /// Returns the parameters of its dynamics.
    #[inline(always)]
    pub(crate) fn dynprm(self) -> &'a [T; 10] {
        &self.params.actuator_dynprm[self.u]
    }

    /// Returns the parameters of its gain.
    #[inline(always)]
    pub(crate) fn gainprm(self) -> &'a [T; 10] {
        &self.params.actuator_gainprm[self.u]
    }

    /// Returns the parameters of its bias.
    #[inline(always)]
    pub(crate) fn biasprm(self) -> &'a [T; 10] {
        &self.params.actuator_biasprm[self.u]
    }
}

/// Returns the relative error with which a force scaled to the end of a range may miss it.
#[inline(always)]
pub(super) fn scaling_error<T: Real>() -> T {
    T::new(SUM_ROUNDING).max(T::splat(T::Scalar::EPSILON) * T::new(16.0))
}

/// The relative error within which a sum of scaled forces is at the end of a range (as in MuJoCo).
pub(super) const SUM_ROUNDING: f64 = 1e-10;
