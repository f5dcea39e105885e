//! Frames of bodies, geoms, sites and cameras: their poses, velocities and accelerations.

use crate::dynamics::camera::camera_pose;
use crate::dynamics::chains::BodyPoint;
use crate::geometry::Geoms;
use crate::model::{FrameObject, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Mat3, Motion, Quat, Real, Vec3};

/// The frames of a configuration.
#[derive(Clone, Copy)]
pub struct Frames<'a, T: Real> {
    /// The model.
    pub model: &'a Model,
    /// The parameters of the model.
    pub params: &'a Params<T>,
    /// The poses of all objects.
    pub pos: &'a Positions<T>,
}

impl<'a, T: Real> Frames<'a, T> {
    /// Returns the frames of the configuration of `geoms`.
    #[inline(always)]
    pub fn of(geoms: Geoms<'a, T>) -> Self {
        Frames {
            model: geoms.model,
            params: geoms.params,
            pos: geoms.position,
        }
    }

    /// Returns the position of an object.
    #[inline(always)]
    pub fn position(&self, object: FrameObject) -> Vec3<T> {
        match object {
            FrameObject::Inertial(body) => self.pos.xipos[body],
            FrameObject::Body(body) => self.pos.xpos[body],
            FrameObject::Geom(geom) => self.pos.geom_xpos[geom],
            FrameObject::Site(site) => self.pos.site_xpos[site],
            FrameObject::Camera(camera) => self.camera(camera).0,
        }
    }

    /// Returns its axes as columns.
    #[inline(always)]
    pub fn rotation(&self, object: FrameObject) -> Mat3<T> {
        match object {
            FrameObject::Inertial(body) => self.pos.ximat[body],
            FrameObject::Body(body) => self.pos.xmat[body],
            FrameObject::Geom(geom) => self.pos.geom_xmat[geom],
            FrameObject::Site(site) => self.pos.site_xmat[site],
            FrameObject::Camera(camera) => self.camera(camera).1,
        }
    }

    /// Returns its orientation, with the sign of its body's.
    #[inline(always)]
    pub fn orientation(&self, object: FrameObject) -> Quat<T> {
        let (body, params) = (self.pos.xquat[object.body(self.model)], self.params);
        match object {
            FrameObject::Inertial(b) => body * params.body_iquat[b],
            FrameObject::Body(_) => body,
            FrameObject::Geom(geom) => body * params.geom_quat[geom],
            FrameObject::Site(site) => body * params.site_quat[site],
            // As in MuJoCo, cameras of all modes count as fixed to their bodies.
            FrameObject::Camera(camera) => body * params.cam_quat[camera],
        }
    }

    fn camera(&self, camera: usize) -> (Vec3<T>, Mat3<T>) {
        camera_pose(self.model, self.params, self.pos, camera)
    }

    /// Returns the body point at an object's position.
    #[inline(always)]
    pub fn point(&self, object: FrameObject) -> BodyPoint<T> {
        let body = object.body(self.model);
        BodyPoint::new(self.model, self.pos, body, self.position(object))
    }

    /// Returns the velocity of the body point at an object's position, in world axes.
    #[inline(always)]
    pub fn velocity(&self, object: FrameObject, vel: &Velocities<T>) -> Motion<T> {
        let point = self.point(object);
        let cvel = vel.cvel[point.body];
        Motion::new(cvel.angular, cvel.velocity_at(point.offset))
    }

    /// Returns the acceleration of the body point at an object's position, in world axes, with gravity's upward
    /// reaction, from the accelerations of bodies. A spatial acceleration is the velocity field's change at a fixed
    /// point; the body point also moves, which adds ω × v.
    #[inline(always)]
    pub fn acceleration(
        &self,
        object: FrameObject,
        vel: &Velocities<T>,
        cacc: &[Motion<T>],
    ) -> Motion<T> {
        let point = self.point(object);
        let cacc = cacc[point.body];
        let velocity = self.velocity(object, vel);
        let linear = cacc.velocity_at(point.offset) + velocity.angular.cross(velocity.linear);
        Motion::new(cacc.angular, linear)
    }
}

/// The axes of output vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// The axes of the world.
    #[default]
    World,
    /// The axes of the object.
    Local,
}

/// Returns the motion of an object, linear and then angular, in the requested axes.
pub fn along<T: Real>(
    frames: Frames<T>,
    axes: Axes,
    object: FrameObject,
    motion: Motion<T>,
) -> [Vec3<T>; 2] {
    let world = [motion.linear, motion.angular];
    match axes {
        Axes::World => world,
        Axes::Local => {
            let rotation = frames.rotation(object);
            world.map(|v| rotation.transpose_mul(v))
        }
    }
}
