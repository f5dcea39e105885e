//! Motion of objects and points of bodies: Jacobians and their rates, velocities, accelerations.
//!
//! The first three of six values or rows are linear, m/s, the last three angular, rad/s, so that a Jacobian times the
//! dof velocities is a velocity in the form that is returned here.

use super::checks::{check_body, check_object};
use super::table::{Place, Query};
use crate::Precision;
use crate::sim::Sim;
use clench_dynamics::check::check_length;
use clench_dynamics::dynamics::frames::Axes;
use clench_dynamics::error::SimError;
use clench_dynamics::model::FrameObject;
use clench_math::Vec3;

/// A point that moves with a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor<T> {
    /// The position of an object.
    Object(FrameObject),
    /// The point of a body that is at a world position now, m.
    Point {
        /// The body.
        body: usize,
        /// The world position.
        place: Vec3<T>,
    },
}

impl<T: Precision> Sim<T> {
    /// Writes the Jacobian of an object or point to `jacobian` (6, nv), row by row: three rows of its velocity, three
    /// of its body's angular velocity, world axes, at the poses of [`refresh`](Self::refresh). As MuJoCo's `mj_jac`.
    ///
    /// # Errors
    /// Returns an error if there is no such object or a length is wrong, or as [`refresh`](Self::refresh) does.
    pub fn jacobian(&mut self, anchor: Anchor<T>, jacobian: &mut [T]) -> Result<(), SimError> {
        let (place, input) = self.check_jacobian(anchor, jacobian.len())?;
        let input = input.as_slice().as_flattened();
        self.write_answer(Query::Jacobian(place), input, jacobian)
    }

    /// Writes the time derivative of that Jacobian (6, nv), as MuJoCo's `mj_jacDot`: 1/s times the units of the
    /// Jacobian.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn jacobian_rate(&mut self, anchor: Anchor<T>, rate: &mut [T]) -> Result<(), SimError> {
        let (place, input) = self.check_jacobian(anchor, rate.len())?;
        let input = input.as_slice().as_flattened();
        self.write_answer(Query::JacobianRate(place), input, rate)
    }

    /// Writes the Jacobian of the centre of mass of a body's subtree to `jacobian` (3, nv), as MuJoCo's
    /// `mj_jacSubtreeCom`.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn subtree_jacobian(&mut self, body: usize, jacobian: &mut [T]) -> Result<(), SimError> {
        check_body(self.model(), body)?;
        check_length("jacobian", jacobian.len(), 3 * self.model().nv)?;
        self.write_answer(Query::SubtreeJacobian(body), &[], jacobian)
    }

    /// Returns the velocity of an object, linear at its position, then angular, in the state of
    /// [`refresh`](Self::refresh). MuJoCo's `mj_objectVelocity` has them in the other order.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn velocity(&mut self, object: FrameObject, axes: Axes) -> Result<[Vec3<T>; 2], SimError> {
        self.two_vectors(object, Query::Velocity(object, axes))
    }

    /// Returns the acceleration of an object in the same form, as MuJoCo's `mj_objectAcceleration`: that of an
    /// accelerometer, including gravity's upward reaction, m/s² and rad/s².
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn acceleration(
        &mut self,
        object: FrameObject,
        axes: Axes,
    ) -> Result<[Vec3<T>; 2], SimError> {
        self.two_vectors(object, Query::Acceleration(object, axes))
    }

    fn two_vectors(
        &mut self,
        object: FrameObject,
        query: Query<'_>,
    ) -> Result<[Vec3<T>; 2], SimError> {
        check_object(self.model(), object)?;
        let mut values = [T::ZERO; 6];
        self.write_answer(query, &[], &mut values)?;
        Ok([Vec3::from_slice(&values), Vec3::from_slice(&values[3..])])
    }

    /// Checks the arguments of a Jacobian. Returns its place and input.
    fn check_jacobian(
        &self,
        anchor: Anchor<T>,
        length: usize,
    ) -> Result<(Place, Option<[T; 3]>), SimError> {
        let found = match anchor {
            Anchor::Object(object) => {
                check_object(self.model(), object)?;
                (Place::Object(object), None)
            }
            Anchor::Point { body, place } => {
                check_body(self.model(), body)?;
                (Place::PointOf(body), Some(place.to_array()))
            }
        };
        check_length("jacobian", length, 6 * self.model().nv)?;
        Ok(found)
    }
}
