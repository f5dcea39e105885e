//! Scaling of elements of the tree: joints, geoms, sites, cameras, lights, inertias. Their positions are scaled with
//! the frame.

use super::{Coordinate, Scale};
use crate::mjcf::linear_map::{Deformation, LinearMap, nearly_equal};
use clench_builder::{
    CameraLens, CameraSpec, DOF_NUMBERS, GeomMass, GeomSpec, InertiaSpec, InertialSpec,
    JOINT_NUMBERS, JointSpec, LightSpec, SiteSpec,
};
use clench_collide::ShapeKind;
use clench_dynamics::model::JointKind;
use clench_math::{Mat3, Vec3};

impl Coordinate {
    /// Returns the quantity that a joint coordinate measures; a free joint has both.
    pub(super) fn of_joint(kind: JointKind) -> Option<Coordinate> {
        match kind {
            JointKind::Slide => Some(Coordinate::Length),
            JointKind::Hinge | JointKind::Ball => Some(Coordinate::Angle),
            JointKind::Free => None,
        }
    }
}

impl Scale {
    /// Scales a joint; returns the factor of lengths along its axis. As in MuJoCo, a free joint is unchanged.
    ///
    /// # Errors
    /// Returns an error if `linear_map`, the frame's map in the axes of the body, rotates the joint axis.
    pub(in crate::mjcf) fn joint(
        self,
        joint: &mut JointSpec,
        linear_map: LinearMap,
    ) -> Result<f64, &'static str> {
        let Some(coordinate) = Coordinate::of_joint(joint.kind) else {
            return Ok(1.0);
        };
        let length = match joint.kind {
            JointKind::Ball => Some(self.length),
            _ => linear_map.factor_along(joint.axis),
        };
        let length = length.ok_or("its axis is not aligned with the axes of the scale")?;
        let along = self.along_direction(coordinate, length);
        joint.range = joint.range.map(|end| end * along.coordinate);
        joint.reference *= along.coordinate;
        joint.springref *= along.coordinate;
        joint.solimp_limit[2] *= along.coordinate;
        joint.solimp_friction[2] *= along.coordinate;
        joint.actuatorfrcrange = joint.actuatorfrcrange.map(|end| end * along.force);
        along.element_numbers(&JOINT_NUMBERS, &mut joint.joint_numbers_mut());
        along.element_numbers(&DOF_NUMBERS, &mut joint.dof_numbers_mut());
        along.polynomial(&mut joint.stiffness);
        along.polynomial(&mut joint.damping);
        Ok(length)
    }

    /// Scales a geom.
    ///
    /// # Errors
    /// Returns an error if the kind of shape would change.
    pub(in crate::mjcf) fn geom(
        self,
        geom: &mut GeomSpec,
        deformation: Deformation,
    ) -> Result<(), &'static str> {
        let linear_map = deformation.linear_map;
        geom.size = match linear_map {
            LinearMap::Uniform(_) => geom.size * self.length,
            // A shape fitted to a mesh gets its size from the mesh.
            LinearMap::General(_) if !geom.mesh.is_empty() => geom.size,
            LinearMap::General(_) => self.shape(geom.kind, geom.size, deformation)?,
        };
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
        let linear = linear_map.apply(Vec3::new(*x, *y, *z));
        [*x, *y, *z] = linear.to_array();
        Ok(())
    }

    /// Returns the size of a shape after a map that is not uniform.
    fn shape(
        self,
        kind: ShapeKind,
        size: Vec3<f64>,
        deformation: Deformation,
    ) -> Result<Vec3<f64>, &'static str> {
        let linear_map = deformation.linear_map;
        let [x, y, z] = linear_map.factors().to_array();
        let factors = match kind {
            ShapeKind::Sphere => [(x * y * z).cbrt(), 1.0, 1.0],
            // The third number of a plane is not part of its shape.
            ShapeKind::Plane => [x, y, self.length],
            ShapeKind::HeightField | ShapeKind::Mesh => [1.0; 3],
            _ => along_and_across(kind, deformation),
        };
        let (axes, equal): (usize, &[f64]) = match kind {
            ShapeKind::Sphere => (3, &[x, y, z]),
            ShapeKind::Capsule | ShapeKind::Cylinder => (3, &[x, y]),
            ShapeKind::Box | ShapeKind::Ellipsoid if deformation.segment => (3, &[x, y]),
            ShapeKind::Box | ShapeKind::Ellipsoid | ShapeKind::HeightField => (3, &[]),
            ShapeKind::Plane => (2, &[]),
            ShapeKind::Mesh => (0, &[]),
        };
        if !nearly_equal(equal) {
            return Err(match kind {
                ShapeKind::Sphere => {
                    "a sphere has only one scale: use an ellipsoid where it differs between axes"
                }
                _ => "its shape can only have the same scale in all directions across its axis",
            });
        }
        if !linear_map.keeps_axes(axes) {
            return Err("its shape is not aligned with the axes of the scale");
        }
        Ok(size.scale_by(Vec3::from_array(factors)))
    }

    /// Scales a site. As it is only a marker, its kind is retained: the sizes are scaled along its axes.
    pub(in crate::mjcf) fn site(self, site: &mut SiteSpec, deformation: Deformation) {
        // Numbers that its kind does not use are unchanged.
        let factors = match site.kind {
            ShapeKind::Sphere => [self.length, 1.0, 1.0],
            kind => along_and_across(kind, deformation),
        };
        for (size, factor) in site.size.iter_mut().zip(factors) {
            *size *= factor;
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

    /// Scales the inertia of a body; `linear_map` is the frame's map in its axes.
    pub(in crate::mjcf) fn inertial(self, inertial: &mut InertialSpec, linear_map: LinearMap) {
        inertial.mass *= self.mass;
        if self.by_axis {
            inertial.inertia = self.stretched(inertial, linear_map);
            return;
        }
        let moments = self.mass * self.length * self.length;
        inertial.inertia = match inertial.inertia {
            InertiaSpec::Diagonal(given) => InertiaSpec::Diagonal(given.map(|i| i * moments)),
            InertiaSpec::Full(given) => InertiaSpec::Full(given.map(|i| i * moments)),
        };
    }

    /// Returns the inertia after a map A: the second moments of mass Σ = ½ tr(I) − I become A Σ Aᵀ, times the mass
    /// factor.
    fn stretched(self, inertial: &InertialSpec, linear_map: LinearMap) -> InertiaSpec {
        let inertia = match inertial.inertia {
            InertiaSpec::Diagonal(moments) => {
                let axes = inertial.quat.normalize().to_matrix();
                axes * (Mat3::diagonal(Vec3::from_array(moments)) * axes.transpose())
            }
            InertiaSpec::Full([xx, yy, zz, xy, xz, yz]) => Mat3::from_rows(
                Vec3::new(xx, xy, xz),
                Vec3::new(xy, yy, yz),
                Vec3::new(xz, yz, zz),
            ),
        };
        let from_trace = |matrix: Mat3<f64>, share: f64| {
            let [a, b, c] = matrix.rows;
            let trace = share * (a.x + b.y + c.z);
            let rows = Mat3::diagonal(Vec3::new(trace, trace, trace)).rows;
            Mat3::from_rows(rows[0] - a, rows[1] - b, rows[2] - c)
        };
        let map = linear_map.to_matrix();
        let moments = map * (from_trace(inertia, 0.5) * map.transpose());
        let [a, b, c] = from_trace(moments, 1.0).rows;
        InertiaSpec::Full([a.x, b.y, c.z, a.y, a.z, b.z].map(|i| i * self.mass))
    }
}

/// Returns the factors of the sizes of a shape with one axis or three.
fn along_and_across(kind: ShapeKind, deformation: Deformation) -> [f64; 3] {
    let [x, y, z] = deformation.linear_map.factors().to_array();
    let across = match deformation.linear_map {
        LinearMap::Uniform(factor) => factor,
        LinearMap::General(_) => (x * y).sqrt(),
    };
    match (kind, deformation.segment) {
        (ShapeKind::Capsule | ShapeKind::Cylinder, false) => [across, z, 1.0],
        (ShapeKind::Capsule | ShapeKind::Cylinder, true) => [across, 1.0, 1.0],
        (_, false) => [x, y, z],
        (_, true) => [across, across, 1.0],
    }
}
