//! Motion of objects and points of bodies: Jacobians and their rates, velocities, accelerations.
//!
//! The first three of six values or rows are linear, m/s, the last three angular, rad/s, so that a Jacobian times the
//! dof velocities is a velocity in the form that is returned here.

use super::{check_body, check_object};
use crate::Precision;
use crate::sim::Sim;
use crate::validity::Computed;
use clench_dynamics::check::check_length;
use clench_dynamics::dynamics::chains::BodyPoint;
use clench_dynamics::dynamics::frames::{Axes, Frames, along};
use clench_dynamics::dynamics::jacobian::{point_jacobian, point_jacobian_rate, subtree_jacobian};
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
        self.check_jacobian(anchor, jacobian.len())?;
        self.require(Computed::Positions)?;
        self.change(jacobian, |sim, jacobian| {
            let point = sim.body_point(anchor);
            point_jacobian(sim.model(), &sim.workspace().position, &point, jacobian);
        });
        Ok(())
    }

    /// Writes the time derivative of that Jacobian (6, nv), as MuJoCo's `mj_jacDot`: 1/s times the units of the
    /// Jacobian.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn jacobian_rate(&mut self, anchor: Anchor<T>, rate: &mut [T]) -> Result<(), SimError> {
        self.check_jacobian(anchor, rate.len())?;
        self.require(Computed::Everything)?;
        self.change(rate, |sim, rate| {
            let (point, ws) = (sim.body_point(anchor), sim.workspace());
            point_jacobian_rate(sim.model(), (&ws.position, &ws.velocity), &point, rate);
        });
        Ok(())
    }

    /// Writes the Jacobian of the centre of mass of a body's subtree to `jacobian` (3, nv), as MuJoCo's
    /// `mj_jacSubtreeCom`.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn subtree_jacobian(&mut self, body: usize, jacobian: &mut [T]) -> Result<(), SimError> {
        check_body(self.model(), body)?;
        check_length("jacobian", jacobian.len(), 3 * self.model().nv)?;
        self.require(Computed::Positions)?;
        self.change(jacobian, |sim, jacobian| {
            let pos = &sim.workspace().position;
            subtree_jacobian(sim.model(), sim.params(), pos, body, jacobian);
        });
        Ok(())
    }

    /// Returns the velocity of an object, linear at its position, then angular, in the state of
    /// [`refresh`](Self::refresh). MuJoCo's `mj_objectVelocity` has them in the other order.
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn velocity(&mut self, object: FrameObject, axes: Axes) -> Result<[Vec3<T>; 2], SimError> {
        check_object(self.model(), object)?;
        self.require(Computed::Everything)?;
        let velocity = self.frames().velocity(object, &self.workspace().velocity);
        Ok(along(self.frames(), axes, object, velocity).map(|vector| vector.lane(0)))
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
        check_object(self.model(), object)?;
        self.require(Computed::Everything)?;
        self.update_body_forces();
        let ws = self.workspace();
        let cacc = &ws.sensors.bodies.cacc;
        let acceleration = self.frames().acceleration(object, &ws.velocity, cacc);
        Ok(along(self.frames(), axes, object, acceleration).map(|vector| vector.lane(0)))
    }

    fn frames(&self) -> Frames<'_, T::SingleEnv> {
        Frames {
            model: self.model(),
            params: self.params(),
            pos: &self.workspace().position,
        }
    }

    fn check_jacobian(&self, anchor: Anchor<T>, length: usize) -> Result<(), SimError> {
        match anchor {
            Anchor::Object(object) => check_object(self.model(), object)?,
            Anchor::Point { body, .. } => check_body(self.model(), body)?,
        }
        check_length("jacobian", length, 6 * self.model().nv)
    }

    pub(super) fn body_point(&self, anchor: Anchor<T>) -> BodyPoint<T::SingleEnv> {
        match anchor {
            Anchor::Object(object) => self.frames().point(object),
            Anchor::Point { body, place } => {
                let pos = &self.workspace().position;
                BodyPoint::new(self.model(), pos, body, Vec3::splat(place))
            }
        }
    }
}
