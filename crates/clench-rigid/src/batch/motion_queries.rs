//! Queries of all environments at once about the motion of objects and the mass matrix.

use super::{Batch, Precision, Rows};
use crate::query::{Place, Query, QueryInput};
use clench_dynamics::dynamics::frames::Axes;
use clench_dynamics::error::SimError;
use clench_dynamics::model::FrameObject;

/// An object, or a point of a body in each environment.
#[derive(Clone, Copy, Debug)]
pub enum Anchors<'a, S> {
    /// The position of an object.
    Object(FrameObject),
    /// The points of a body that are at world positions now, m.
    Points {
        /// The body.
        body: usize,
        /// The world positions, three numbers per environment.
        places: QueryInput<'a, S>,
    },
}

impl<S: Precision> Batch<S> {
    /// Returns the Jacobian of an object or point in each environment (n, 6 × nv), see
    /// [`Sim::jacobian`](crate::Sim::jacobian).
    ///
    /// # Errors
    /// Returns an error if there is no such object, if the number of positions is wrong or one is not finite, or as
    /// [`step`](Self::step) does.
    pub fn jacobian(&mut self, anchors: Anchors<'_, S>) -> Result<Rows<S>, SimError> {
        let (place, input) = place(anchors);
        self.answer(Query::Jacobian(place), input)
    }

    /// Returns the time derivative of that Jacobian (n, 6 × nv), see
    /// [`Sim::jacobian_rate`](crate::Sim::jacobian_rate).
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn jacobian_rate(&mut self, anchors: Anchors<'_, S>) -> Result<Rows<S>, SimError> {
        let (place, input) = place(anchors);
        self.answer(Query::JacobianRate(place), input)
    }

    /// Returns the velocity of an object in the present state of each environment (n, 6), linear, then angular, see
    /// [`Sim::velocity`](crate::Sim::velocity).
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn velocity(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        self.answer(Query::Velocity(object, axes), QueryInput::Shared(&[]))
    }

    /// Returns the acceleration of an object in the same form, see [`Sim::acceleration`](crate::Sim::acceleration). It
    /// runs all of forward dynamics. Environments that fail get NaN.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn acceleration(&mut self, object: FrameObject, axes: Axes) -> Result<Rows<S>, SimError> {
        self.answer(Query::Acceleration(object, axes), QueryInput::Shared(&[]))
    }

    /// Returns M x (n, nv) with the mass matrices of the present states, see [`Sim::mul_mass`](crate::Sim::mul_mass).
    ///
    /// # Errors
    /// Returns an error if the number of values is wrong or one is not finite, or as [`step`](Self::step) does.
    pub fn mul_mass(&mut self, x: QueryInput<S>) -> Result<Rows<S>, SimError> {
        self.answer(Query::MulMass, x)
    }

    /// Returns M⁻¹ x (n, nv), see [`Sim::solve_mass`](crate::Sim::solve_mass); NaN for a singular mass matrix.
    ///
    /// # Errors
    /// See [`mul_mass`](Self::mul_mass).
    pub fn solve_mass(&mut self, x: QueryInput<S>) -> Result<Rows<S>, SimError> {
        self.answer(Query::SolveMass, x)
    }
}

/// Returns the place and input of a Jacobian.
fn place<S>(anchors: Anchors<'_, S>) -> (Place, QueryInput<'_, S>) {
    match anchors {
        Anchors::Object(object) => (Place::Object(object), QueryInput::Shared(&[])),
        Anchors::Points { body, places } => (Place::PointOf(body), places),
    }
}
