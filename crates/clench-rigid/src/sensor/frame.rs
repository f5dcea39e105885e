//! Frame sensors: poses, velocities and accelerations of objects.
//!
//! Given R, p, ω, v of the reference frame, an object at p' that moves with ω', v' has the relative position Rᵀ(p' −
//! p), angular velocity Rᵀ(ω' − ω) and linear velocity Rᵀ(v' − v − ω × (p' − p)).

use super::read::Reading;
use clench_dynamics::model::{FrameObject, SensorKind};
use clench_dynamics::sensor_group;
use clench_math::{Mat3, Motion, Quat, Real, Vec3, kernel};

impl<T: Real> Reading<'_, T> {
    /// Writes a frame sensor, relative to another frame or to the world.
    #[kernel]
    pub(super) fn read_frame(
        &self,
        kind: SensorKind,
        object: FrameObject,
        reference: Option<FrameObject>,
        out: &mut [T],
    ) {
        use SensorKind as Kind;
        let axis = |k: usize| {
            let axis = self.rotation(object).column(k);
            match reference {
                Some(reference) => self.rotation(reference).transpose_mul(axis),
                None => axis,
            }
        };
        match kind {
            Kind::FramePos => self.relative_position(object, reference).write(out),
            Kind::FrameQuat => {
                let quat = self.orientation(object);
                match reference {
                    Some(reference) => self.orientation(reference).conjugate() * quat,
                    None => quat,
                }
                .write(out);
            }
            Kind::FrameXAxis => axis(0).write(out),
            Kind::FrameYAxis => axis(1).write(out),
            Kind::FrameZAxis => axis(2).write(out),
            Kind::FrameLinVel => self.relative_velocity(object, reference).linear.write(out),
            Kind::FrameAngVel => self.relative_velocity(object, reference).angular.write(out),
            Kind::FrameLinAcc => self.acceleration(object).linear.write(out),
            Kind::FrameAngAcc => self.acceleration(object).angular.write(out),
            // The builder gives these kinds other targets.
            sensor_group!(whole)
            | sensor_group!(element)
            | sensor_group!(geoms)
            | sensor_group!(others) => out.fill(T::ZERO),
        }
    }

    /// Returns the position of an object.
    pub(super) fn position(&self, object: FrameObject) -> Vec3<T> {
        self.frames().position(object)
    }

    /// Returns its axes as columns.
    pub(super) fn rotation(&self, object: FrameObject) -> Mat3<T> {
        self.frames().rotation(object)
    }

    /// Returns its orientation, with the sign of its body's quaternion.
    fn orientation(&self, object: FrameObject) -> Quat<T> {
        self.frames().orientation(object)
    }

    #[kernel]
    fn relative_position(&self, object: FrameObject, reference: Option<FrameObject>) -> Vec3<T> {
        let position = self.position(object);
        match reference {
            Some(reference) => self
                .rotation(reference)
                .transpose_mul(position - self.position(reference)),
            None => position,
        }
    }

    /// Returns the velocity of the body point at an object's position, world axes.
    pub(super) fn velocity(&self, object: FrameObject) -> Motion<T> {
        self.frames().velocity(object, &self.ws.velocity)
    }

    #[kernel]
    fn relative_velocity(&self, object: FrameObject, reference: Option<FrameObject>) -> Motion<T> {
        let velocity = self.velocity(object);
        let Some(reference) = reference else {
            return velocity;
        };
        let own = self.velocity(reference);
        let arm = self.position(object) - self.position(reference);
        let carried = own.velocity_at(arm);
        let axes = self.rotation(reference);
        Motion::new(
            axes.transpose_mul(velocity.angular - own.angular),
            axes.transpose_mul(velocity.linear - carried),
        )
    }

    /// Returns the acceleration of the body point at an object's position, world axes, including gravity's upward
    /// reaction.
    pub(super) fn acceleration(&self, object: FrameObject) -> Motion<T> {
        let cacc = &self.ws.sensors.bodies.cacc;
        self.frames().acceleration(object, &self.ws.velocity, cacc)
    }
}
