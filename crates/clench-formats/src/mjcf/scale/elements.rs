//! What stands in the tree: joints, geoms, sites, cameras, lights, inertias. Their positions are scaled with the frame.

use super::{Coordinate, Scale};
use clench_collide::ShapeKind;
use clench_rigid::builder::{
    CameraLens, CameraSpec, GeomMass, GeomSpec, InertiaSpec, InertialSpec, JointSpec, LightSpec,
    SiteSpec,
};
use clench_rigid::model::JointKind;

impl Coordinate {
    /// What the coordinate of a joint measures; a free joint has both.
    pub(super) fn of_joint(kind: JointKind) -> Option<Coordinate> {
        match kind {
            JointKind::Slide => Some(Coordinate::Length),
            JointKind::Hinge | JointKind::Ball => Some(Coordinate::Angle),
            JointKind::Free => None,
        }
    }
}

impl Scale {
    /// As in MuJoCo, what a free joint has along its degrees of freedom stays as it is.
    pub(in crate::mjcf) fn joint(self, joint: &mut JointSpec) {
        let Some(coordinate) = Coordinate::of_joint(joint.kind) else {
            return;
        };
        let along = self.along(coordinate);
        joint.range = joint.range.map(|end| end * along.coordinate);
        joint.margin *= along.coordinate;
        joint.reference *= along.coordinate;
        joint.springref *= along.coordinate;
        joint.springyield *= along.coordinate;
        joint.solimp_limit[2] *= along.coordinate;
        joint.solimp_friction[2] *= along.coordinate;
        joint.actuatorfrcrange = joint.actuatorfrcrange.map(|end| end * along.force);
        joint.frictionloss *= along.force;
        joint.armature *= along.gain();
        along.polynomial(&mut joint.stiffness);
        along.polynomial(&mut joint.damping);
    }

    pub(in crate::mjcf) fn geom(self, geom: &mut GeomSpec) {
        geom.size = geom.size * self.length;
        geom.mass = match geom.mass {
            GeomMass::Mass(mass) => GeomMass::Mass(mass * self.mass),
            GeomMass::Density(density) => {
                let lengths = if geom.shellinertia { 2 } else { 3 };
                GeomMass::Density(density * self.mass / self.length.powi(lengths))
            }
        };
        geom.friction[1] *= self.length;
        geom.friction[2] *= self.length;
        geom.margin *= self.length;
        geom.gap *= self.length;
        geom.solimp[2] *= self.length;
        geom.adhesion *= self.force(1);
        let [x, y, z, ..] = &mut geom.surfacevel;
        for linear in [x, y, z] {
            *linear *= self.length;
        }
    }

    pub(in crate::mjcf) fn site(self, site: &mut SiteSpec) {
        // Numbers that its kind does not use stay as they are written.
        let used = match site.kind {
            ShapeKind::Sphere => 1,
            ShapeKind::Capsule | ShapeKind::Cylinder => 2,
            _ => 3,
        };
        for size in &mut site.size[..used] {
            *size *= self.length;
        }
    }

    pub(in crate::mjcf) fn camera(self, camera: &mut CameraSpec) {
        if let CameraLens::Intrinsic {
            sensorsize,
            focal,
            principal,
        } = &mut camera.lens
        {
            for length in sensorsize.iter_mut().chain(focal).chain(principal) {
                *length *= self.length;
            }
        }
    }

    pub(in crate::mjcf) fn light(self, light: &mut LightSpec) {
        let [_, linear, quadratic] = &mut light.properties.attenuation;
        *linear /= self.length;
        *quadratic /= self.length * self.length;
    }

    pub(in crate::mjcf) fn inertial(self, inertial: &mut InertialSpec) {
        let moments = self.mass * self.length * self.length;
        inertial.mass *= self.mass;
        inertial.inertia = match inertial.inertia {
            InertiaSpec::Diagonal(given) => InertiaSpec::Diagonal(given.map(|i| i * moments)),
            InertiaSpec::Full(given) => InertiaSpec::Full(given.map(|i| i * moments)),
        };
    }
}
