//! Frames of objects: where they are, how they move and accelerate.
//!
//! With R, p, ω, v of the reference frame, an object at p' that moves with ω', v' has there the position Rᵀ(p' − p), the angular
//! velocity Rᵀ(ω' − ω) and the linear velocity Rᵀ(v' − v − ω × (p' − p)).

use super::Reading;
use crate::dynamics::camera::camera_pose;
use crate::model::{FrameObject, SensorKind};
use clench_math::{Mat3, Motion, Quat, Real, Vec3};

impl<T: Real> Reading<'_, T> {
    /// A sensor of a frame, relative to another or in the world.
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
            _ => out.fill(T::ZERO),
        }
    }

    /// The body that carries an object.
    pub(super) fn body(&self, object: FrameObject) -> usize {
        match object {
            FrameObject::Inertial(body) | FrameObject::Body(body) => body,
            FrameObject::Geom(geom) => self.model.geoms[geom].body,
            FrameObject::Site(site) => self.model.sites[site].body,
            FrameObject::Camera(camera) => self.model.cameras[camera].body,
        }
    }

    /// Where an object is.
    pub(super) fn position(&self, object: FrameObject) -> Vec3<T> {
        let pos = &self.ws.position;
        match object {
            FrameObject::Inertial(body) => pos.xipos[body],
            FrameObject::Body(body) => pos.xpos[body],
            FrameObject::Geom(geom) => pos.geom_xpos[geom],
            FrameObject::Site(site) => pos.site_xpos[site],
            FrameObject::Camera(camera) => self.camera(camera).0,
        }
    }

    /// Its axes as columns.
    pub(super) fn rotation(&self, object: FrameObject) -> Mat3<T> {
        let pos = &self.ws.position;
        match object {
            FrameObject::Inertial(body) => pos.ximat[body],
            FrameObject::Body(body) => pos.xmat[body],
            FrameObject::Geom(geom) => pos.geom_xmat[geom],
            FrameObject::Site(site) => pos.site_xmat[site],
            FrameObject::Camera(camera) => self.camera(camera).1,
        }
    }

    /// Its orientation, with the sign that its body's has.
    fn orientation(&self, object: FrameObject) -> Quat<T> {
        let (body, params) = (self.ws.position.xquat[self.body(object)], self.params);
        match object {
            FrameObject::Inertial(b) => body * params.body_iquat[b],
            FrameObject::Body(_) => body,
            FrameObject::Geom(geom) => body * params.geom_quat[geom],
            FrameObject::Site(site) => body * params.site_quat[site],
            // As if it were fixed to its body, whatever it follows: so it is in MuJoCo.
            FrameObject::Camera(camera) => body * params.cam_quat[camera],
        }
    }

    fn camera(&self, camera: usize) -> (Vec3<T>, Mat3<T>) {
        camera_pose(self.model, self.params, &self.ws.position, camera)
    }

    fn relative_position(&self, object: FrameObject, reference: Option<FrameObject>) -> Vec3<T> {
        let position = self.position(object);
        match reference {
            Some(reference) => self
                .rotation(reference)
                .transpose_mul(position - self.position(reference)),
            None => position,
        }
    }

    /// The velocity of the body point at an object's position, world axes.
    pub(super) fn velocity(&self, object: FrameObject) -> Motion<T> {
        let cvel = self.ws.velocity.cvel[self.body(object)];
        Motion::new(cvel.angular, cvel.velocity_at(self.arm(object)))
    }

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

    /// The acceleration of the body point at an object's position, world axes, with gravity's upward reaction. A spatial
    /// acceleration holds the velocity field's change at a fixed place; the point also moves, which adds ω × v.
    pub(super) fn acceleration(&self, object: FrameObject) -> Motion<T> {
        let cacc = self.ws.sensors.bodies.cacc[self.body(object)];
        let velocity = self.velocity(object);
        let linear = cacc.velocity_at(self.arm(object)) + velocity.angular.cross(velocity.linear);
        Motion::new(cacc.angular, linear)
    }

    /// From the reference point of an object's tree to the object.
    fn arm(&self, object: FrameObject) -> Vec3<T> {
        let root = self.model.bodies[self.body(object)].root;
        self.position(object) - self.ws.position.subtree_com[root]
    }
}
