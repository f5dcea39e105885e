//! Questions to all environments at once about how objects move, and about what the mass matrix makes of numbers.

use super::answer::{Given, Question};
use super::{Batch, Precision, Rows};
use crate::query::check_object;
use clench_dynamics::dynamics::frames::Axes;
use clench_dynamics::error::SimError;
use clench_dynamics::model::FrameObject;

impl<S: Precision> Batch<S> {
    /// The velocity of an object in each environment (n, 6), linear and then angular, in the present states, see
    /// [`Sim::velocity`](crate::Sim::velocity).
    ///
    /// # Errors
    /// As [`jacobian`](Self::jacobian).
    pub fn velocity(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        check_object(&self.model, object)?;
        self.ask(Question::Velocity(object, axes), Given::Shared(&[]), 6)
    }

    /// The acceleration of an object likewise, see [`Sim::acceleration`](crate::Sim::acceleration); NaN in an environment in which
    /// that would be an error. It takes all of forward dynamics.
    ///
    /// # Errors
    /// As [`jacobian`](Self::jacobian).
    pub fn acceleration(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        check_object(&self.model, object)?;
        self.ask(Question::Acceleration(object, axes), Given::Shared(&[]), 6)
    }

    /// M x in each environment (n, nv), with the mass matrices of the present states, see [`Sim::mul_mass`](crate::Sim::mul_mass).
    ///
    /// # Errors
    /// A wrong number of numbers, or such that are not finite; else as [`step`](Self::step).
    pub fn mul_mass(&mut self, x: Given<S>) -> Result<Rows<S>, SimError> {
        let nv = self.model.nv;
        self.check_numbers("x", &x, nv)?;
        self.ask(Question::MulMass, x, nv)
    }

    /// M⁻¹ x likewise, see [`Sim::solve_mass`](crate::Sim::solve_mass); NaN where a mass matrix is singular.
    ///
    /// # Errors
    /// As [`mul_mass`](Self::mul_mass).
    pub fn solve_mass(&mut self, x: Given<S>) -> Result<Rows<S>, SimError> {
        let nv = self.model.nv;
        self.check_numbers("x", &x, nv)?;
        self.ask(Question::SolveMass, x, nv)
    }
}
