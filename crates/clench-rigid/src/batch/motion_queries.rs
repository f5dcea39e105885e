//! Queries of all environments at once about the motion of objects and the mass matrix.

use super::answer::{Query, QueryInput};
use super::{Batch, Precision, Rows};
use crate::query::check_object;
use clench_dynamics::dynamics::frames::Axes;
use clench_dynamics::error::SimError;
use clench_dynamics::model::FrameObject;

impl<S: Precision> Batch<S> {
    /// Returns the velocity of an object in the present state of each environment (n, 6), linear, then angular, see
    /// [`Sim::velocity`](crate::Sim::velocity).
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn velocity(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        check_object(&self.model, object)?;
        self.run_query(Query::Velocity(object, axes), QueryInput::Shared(&[]), 6)
    }

    /// Returns the acceleration of an object in the same form, see [`Sim::acceleration`](crate::Sim::acceleration). It
    /// runs all of forward dynamics. Environments that fail get NaN.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn acceleration(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        check_object(&self.model, object)?;
        self.run_query(
            Query::Acceleration(object, axes),
            QueryInput::Shared(&[]),
            6,
        )
    }

    /// Returns M x (n, nv) with the mass matrices of the present states, see [`Sim::mul_mass`](crate::Sim::mul_mass).
    ///
    /// # Errors
    /// Returns an error if the number of values is wrong or one is not finite, or as [`step`](Self::step) does.
    pub fn mul_mass(&mut self, x: QueryInput<S>) -> Result<Rows<S>, SimError> {
        let nv = self.model.nv;
        self.check_numbers("x", &x, nv)?;
        self.run_query(Query::MulMass, x, nv)
    }

    /// Returns M⁻¹ x (n, nv), see [`Sim::solve_mass`](crate::Sim::solve_mass); NaN for a singular mass matrix.
    ///
    /// # Errors
    /// See [`mul_mass`](Self::mul_mass).
    pub fn solve_mass(&mut self, x: QueryInput<S>) -> Result<Rows<S>, SimError> {
        let nv = self.model.nv;
        self.check_numbers("x", &x, nv)?;
        self.run_query(Query::SolveMass, x, nv)
    }
}
