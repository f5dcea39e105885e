//! Constructors and setters for the most common parts of a description in Rust. Every other field is public, and
//! settable by struct update syntax: `GeomSpec { condim: 6, ..GeomSpec::sphere(0.1) }`.

use super::model_builder::ModelBuilder;
use super::{
    ActuatorSpec, BodySpec, DEFAULT_SOLIMP, DEFAULT_SOLREF, EqualityKind, EqualitySpec, GeomMass,
    GeomSpec, HistorySpec, InertiaSpec, InertialSpec, JointSpec, KeyframeSpec, SiteSpec,
    TendonSpec, TransmissionSpec, WrapSpec,
};
use clench_collide::ShapeKind;
use clench_dynamics::model::{BiasKind, DynamicsKind, GainKind, JointKind};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

impl ModelBuilder {
    /// The index of the world body.
    pub const WORLD: usize = 0;

    /// Creates an empty world.
    pub fn new(name: impl Into<String>) -> Self {
        ModelBuilder {
            name: name.into(),
            ..ModelBuilder::default()
        }
    }

    /// Adds a body to `parent` ([`WORLD`](Self::WORLD) or the result of an earlier call), and returns its index.
    pub fn add_body(&mut self, parent: usize, body: BodySpec) -> usize {
        self.bodies.push(BodySpec { parent, ..body });
        self.bodies.len() - 1
    }

    /// Adds a geom that does not move.
    pub fn add_ground(&mut self, geom: GeomSpec) {
        if self.bodies.is_empty() {
            self.bodies.push(BodySpec::new("world"));
        }
        self.bodies[Self::WORLD].geoms.push(geom);
    }
}

impl BodySpec {
    /// Creates a body at its parent's origin.
    pub fn new(name: impl Into<String>) -> Self {
        BodySpec {
            name: name.into(),
            ..BodySpec::default()
        }
    }
    /// Sets its position in the parent's frame, m.
    #[must_use]
    pub fn at(mut self, pos: [f64; 3]) -> Self {
        self.pos = Vec3::from_array(pos);
        self
    }
    /// Sets its orientation in the parent's frame, (w, x, y, z).
    #[must_use]
    pub fn turned(mut self, quat: [f64; 4]) -> Self {
        self.quat = Quat::from_f64(quat);
        self
    }
    /// Sets mass (kg), centre of mass in the body frame (m) and principal moments along the body's axes (kg m²),
    /// instead of those of its geoms.
    #[must_use]
    pub fn inertial(mut self, mass: f64, centre: [f64; 3], moments: [f64; 3]) -> Self {
        self.inertial = Some(InertialSpec {
            pos: Vec3::from_array(centre),
            quat: Quat::IDENTITY,
            mass,
            inertia: InertiaSpec::Diagonal(moments),
            origin: None,
        });
        self
    }
    /// Adds a joint.
    #[must_use]
    pub fn joint(mut self, joint: JointSpec) -> Self {
        self.joints.push(joint);
        self
    }
    /// Adds a geom.
    #[must_use]
    pub fn geom(mut self, geom: GeomSpec) -> Self {
        self.geoms.push(geom);
        self
    }
    /// Adds a site.
    #[must_use]
    pub fn site(mut self, name: impl Into<String>, pos: [f64; 3]) -> Self {
        self.sites.push(SiteSpec {
            name: name.into(),
            pos: Vec3::from_array(pos),
            ..SiteSpec::default()
        });
        self
    }
}

impl JointSpec {
    fn of_kind(kind: JointKind, name: impl Into<String>, axis: [f64; 3]) -> Self {
        JointSpec {
            name: name.into(),
            kind,
            axis: Vec3::from_array(axis),
            ..JointSpec::default()
        }
    }
    /// Creates a rotation about an axis in the body frame.
    pub fn hinge(name: impl Into<String>, axis: [f64; 3]) -> Self {
        Self::of_kind(JointKind::Hinge, name, axis)
    }
    /// Creates a translation along an axis in the body frame.
    pub fn slide(name: impl Into<String>, axis: [f64; 3]) -> Self {
        Self::of_kind(JointKind::Slide, name, axis)
    }
    /// Creates a joint with all rotations.
    pub fn ball(name: impl Into<String>) -> Self {
        Self::of_kind(JointKind::Ball, name, [0.0, 0.0, 1.0])
    }
    /// Creates a joint with all motions.
    pub fn free(name: impl Into<String>) -> Self {
        Self::of_kind(JointKind::Free, name, [0.0, 0.0, 1.0])
    }
    /// Sets its anchor in the body frame, m.
    #[must_use]
    pub fn at(mut self, pos: [f64; 3]) -> Self {
        self.pos = Vec3::from_array(pos);
        self
    }
    /// Sets its range, rad or m; for a ball joint 0 and the maximum angle.
    #[must_use]
    pub fn limited(mut self, low: f64, high: f64) -> Self {
        self.range = [low, high];
        self.limited = Some(true);
        self
    }
    /// Sets viscous damping, N s/m or N m s/rad.
    #[must_use]
    pub fn damping(mut self, damping: f64) -> Self {
        self.damping = [damping, 0.0, 0.0];
        self
    }
    /// Sets the stiffness of the spring (N/m or N m/rad) and its rest position.
    #[must_use]
    pub fn spring(mut self, stiffness: f64, rest: f64) -> Self {
        (self.stiffness, self.springref) = ([stiffness, 0.0, 0.0], rest);
        self
    }
    /// Sets dry friction, N or N m.
    #[must_use]
    pub fn frictionloss(mut self, frictionloss: f64) -> Self {
        self.frictionloss = frictionloss;
        self
    }
    /// Sets the added inertia, kg or kg m².
    #[must_use]
    pub fn armature(mut self, armature: f64) -> Self {
        self.armature = armature;
        self
    }
}

impl GeomSpec {
    fn of_kind(kind: ShapeKind, size: [f64; 3]) -> Self {
        GeomSpec {
            kind,
            size: Vec3::from_array(size),
            ..GeomSpec::default()
        }
    }
    /// Creates the half-space below the local xy plane.
    pub fn plane() -> Self {
        Self::of_kind(ShapeKind::Plane, [0.0, 0.0, 1.0])
    }
    /// Creates a sphere of radius in m.
    pub fn sphere(radius: f64) -> Self {
        Self::of_kind(ShapeKind::Sphere, [radius, 0.0, 0.0])
    }
    /// Creates a capsule of a radius, m, and half the length of its segment on the local z axis, m.
    pub fn capsule(radius: f64, half_length: f64) -> Self {
        Self::of_kind(ShapeKind::Capsule, [radius, half_length, 0.0])
    }
    /// Creates a cylinder of a radius and half length along local z, m.
    pub fn cylinder(radius: f64, half_length: f64) -> Self {
        Self::of_kind(ShapeKind::Cylinder, [radius, half_length, 0.0])
    }
    /// Creates a box of half lengths along the local axes, m.
    pub fn cuboid(half_lengths: [f64; 3]) -> Self {
        Self::of_kind(ShapeKind::Box, half_lengths)
    }
    /// Creates an ellipsoid of semi-axes in m.
    pub fn ellipsoid(semi_axes: [f64; 3]) -> Self {
        Self::of_kind(ShapeKind::Ellipsoid, semi_axes)
    }
    /// Creates a mesh among `ModelBuilder::meshes`; its convex hull collides.
    pub fn mesh(name: impl Into<String>) -> Self {
        GeomSpec {
            mesh: name.into(),
            ..Self::of_kind(ShapeKind::Mesh, [0.0; 3])
        }
    }
    /// Creates a height field among `ModelBuilder::height_fields`.
    pub fn height_field(name: impl Into<String>) -> Self {
        GeomSpec {
            hfield: name.into(),
            ..Self::of_kind(ShapeKind::HeightField, [0.0; 3])
        }
    }
    /// Sets its name.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }
    /// Sets its position in the body frame, m.
    #[must_use]
    pub fn at(mut self, pos: [f64; 3]) -> Self {
        self.pos = Vec3::from_array(pos);
        self
    }
    /// Sets its orientation in the body frame, (w, x, y, z).
    #[must_use]
    pub fn turned(mut self, quat: [f64; 4]) -> Self {
        self.quat = Quat::from_f64(quat);
        self
    }
    /// Sets its mass, kg.
    #[must_use]
    pub fn mass(mut self, mass: f64) -> Self {
        self.mass = GeomMass::Mass(mass);
        self
    }
    /// Sets its density, kg/m³ (kg/m² for a shell).
    #[must_use]
    pub fn density(mut self, density: f64) -> Self {
        self.mass = GeomMass::Density(density);
        self
    }
    /// Sets slide, spin (m) and roll (m) friction.
    #[must_use]
    pub fn friction(mut self, friction: [f64; 3]) -> Self {
        self.friction = friction;
        self
    }
}

impl ActuatorSpec {
    /// Creates a motor: its force on the target is the control times `gear`.
    pub fn motor(name: impl Into<String>, target: TransmissionSpec, gear: f64) -> Self {
        let mut actuator = Self::general(name, target);
        actuator.gear[0] = gear;
        actuator
    }

    /// Creates a position servo: force `kp (control − position) − kv velocity`.
    pub fn position(name: impl Into<String>, target: TransmissionSpec, kp: f64, kv: f64) -> Self {
        let mut actuator = Self::general(name, target);
        actuator.gainprm[0] = kp;
        actuator.bias = BiasKind::Affine;
        actuator.biasprm[1] = -kp;
        actuator.biasprm[2] = -kv;
        actuator
    }

    /// Creates a velocity servo: force `kv (control − velocity)`.
    pub fn velocity(name: impl Into<String>, target: TransmissionSpec, kv: f64) -> Self {
        let mut actuator = Self::general(name, target);
        actuator.gainprm[0] = kv;
        actuator.bias = BiasKind::Affine;
        actuator.biasprm[2] = -kv;
        actuator
    }

    /// Creates an actuator whose force equals the control: MJCF's `<general>` without attributes.
    pub fn general(name: impl Into<String>, transmission: TransmissionSpec) -> Self {
        let one = |n: f64| {
            let mut prm = [0.0; 10];
            prm[0] = n;
            prm
        };
        ActuatorSpec {
            name: name.into(),
            transmission,
            dynamics: DynamicsKind::None,
            dynprm: one(1.0),
            gain: GainKind::Fixed,
            gainprm: one(1.0),
            bias: BiasKind::None,
            biasprm: [0.0; 10],
            dampratio: None,
            inheritrange: 0.0,
            gear: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            damping: [0.0; 3],
            armature: 0.0,
            history: HistorySpec::default(),
            cranklength: 0.0,
            lengthrange: [0.0; 2],
            ctrlrange: [0.0; 2],
            ctrllimited: None,
            velrange: [0.0; 2],
            ffrange: [0.0; 2],
            inputs: None,
            forcerange: [0.0; 2],
            forcelimited: None,
            actrange: [0.0; 2],
            actlimited: None,
            actdim: None,
            actearly: false,
            group: 0,
            user: Arc::default(),
            origin: None,
        }
    }
}

impl EqualitySpec {
    /// Creates a constraint with MuJoCo's default softness, initially active.
    pub fn new(name: impl Into<String>, kind: EqualityKind) -> Self {
        EqualitySpec {
            name: name.into(),
            kind,
            active: true,
            solref: DEFAULT_SOLREF,
            solimp: DEFAULT_SOLIMP,
            origin: None,
        }
    }
}

impl TendonSpec {
    /// Creates a tendon of length Σ coefficient · joint position.
    pub fn fixed(name: impl Into<String>, terms: &[(&str, f64)]) -> Self {
        TendonSpec {
            name: name.into(),
            path: (terms.iter())
                .map(|&(joint, coef)| WrapSpec::Joint {
                    joint: joint.to_owned(),
                    coef,
                })
                .collect(),
            ..TendonSpec::default()
        }
    }

    /// Creates a string along a path of sites, geoms and pulleys.
    pub fn spatial(name: impl Into<String>, path: Vec<WrapSpec>) -> Self {
        TendonSpec {
            name: name.into(),
            path,
            ..TendonSpec::default()
        }
    }
}

impl KeyframeSpec {
    /// Creates a stored configuration at rest.
    pub fn at(name: impl Into<String>, qpos: Vec<f64>) -> Self {
        KeyframeSpec {
            name: name.into(),
            qpos: Some(qpos),
            ..KeyframeSpec::default()
        }
    }
}
