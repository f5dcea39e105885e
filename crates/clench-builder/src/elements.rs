//! Bodies and what stands on them, with MuJoCo's defaults.

use super::{AppearanceSpec, CameraSpec, CompilerSpec, LightSpec, Origin};
use clench_collide::ShapeKind;
use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{Interpolation, JointKind, SleepPolicy};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// How many constraints can be added at run time, unless the model says otherwise.
pub const DEFAULT_DYNAMIC_CONSTRAINTS: usize = 8;

/// A body: a frame that moves by its joints relative to its parent.
#[derive(Clone, Debug, Default)]
pub struct BodySpec {
    /// Name, possibly empty.
    pub name: String,
    /// Index of the parent in `ModelBuilder::bodies` (the world is its own parent).
    pub parent: usize,
    /// Position in the parent's frame, m.
    pub pos: Vec3<f64>,
    /// Orientation in the parent's frame.
    pub quat: Quat<f64>,
    /// The pose that is written, where frames of the file carried it to `pos` and `quat`.
    pub written: Option<(Vec3<f64>, Quat<f64>)>,
    /// Mass properties, if the author gave them.
    pub inertial: Option<InertialSpec>,
    /// Moved by the user, not by forces; child of the world, without joints.
    pub mocap: bool,
    /// Where the body only slides along coordinate axes, MuJoCo scales its constraints by its mass in every direction. This one's
    /// are scaled as those of any other body, by the mean over all directions (`simple="false"`).
    pub never_simple: bool,
    /// Stays a body of its own where `CompilerSpec::fusestatic` would make it part of its parent.
    pub never_fused: bool,
    /// Whether the tree of which this body is the root may sleep.
    pub sleep: SleepPolicy,
    /// Share of the body's weight that is lifted. As in MuJoCo, shares below zero count only if some body's is positive.
    pub gravcomp: f64,
    /// Joints, in the order in which they act.
    pub joints: Vec<JointSpec>,
    /// Geoms.
    pub geoms: Vec<GeomSpec>,
    /// Sites.
    pub sites: Vec<SiteSpec>,
    /// Cameras.
    pub cameras: Vec<CameraSpec>,
    /// Lights.
    pub lights: Vec<LightSpec>,
    /// The settings of the model that it was attached from, which decide about its inertia and its frame; `None` for those of
    /// the builder.
    pub compiler: Option<Arc<CompilerSpec>>,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// Mass properties given by the author.
#[derive(Clone, Debug)]
pub struct InertialSpec {
    /// Centre of mass in the body frame, m.
    pub pos: Vec3<f64>,
    /// Orientation of the inertial frame in the body frame (ignored with a full inertia).
    pub quat: Quat<f64>,
    /// kg.
    pub mass: f64,
    /// Moments.
    pub inertia: InertiaSpec,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// Rotational inertia about the centre of mass, kg m².
#[derive(Clone, Copy, Debug)]
pub enum InertiaSpec {
    /// Principal moments in the inertial frame.
    Diagonal([f64; 3]),
    /// xx, yy, zz, xy, xz, yz in the body frame.
    Full([f64; 6]),
}

/// A joint.
#[derive(Clone, Debug)]
pub struct JointSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Anchor in the body frame, m.
    pub pos: Vec3<f64>,
    /// Axis in the body frame (normalized by the builder).
    pub axis: Vec3<f64>,
    /// Allowed positions, rad or m; for a ball joint (0, largest angle).
    pub range: [f64; 2],
    /// Whether the range limits the joint; `None`: if `autolimits` and a range is given.
    pub limited: Option<bool>,
    /// Limits of the total actuator force, N or N m.
    pub actuatorfrcrange: [f64; 2],
    /// Whether that range applies; `None` as for `limited`.
    pub actuatorfrclimited: Option<bool>,
    /// Gravity compensation counts as actuation.
    pub actuatorgravcomp: bool,
    /// Distance at which the limit constraint appears.
    pub margin: f64,
    /// Position in the initial configuration.
    pub reference: f64,
    /// Position at which the spring rests.
    pub springref: f64,
    /// Stretch, m or rad, at which the spring yields, so that its rest follows; 0 where it never does.
    pub springyield: f64,
    /// Coefficients of the spring, which pulls with a x + b x² + c x³ at a displacement x, N/m or N m/rad.
    pub stiffness: [f64; 3],
    /// Coefficients of the damper, which brakes with a v + b v |v| + c v³ at a velocity v, N s/m or N m s/rad.
    pub damping: [f64; 3],
    /// Time constant and damping ratio from which the linear stiffness and damping are derived, where positive.
    pub springdamper: [f64; 2],
    /// Added inertia of the joint, kg or kg m².
    pub armature: f64,
    /// Dry friction, N or N m.
    pub frictionloss: f64,
    /// Limit reference dynamics.
    pub solref_limit: [f64; 2],
    /// Limit impedance.
    pub solimp_limit: [f64; 5],
    /// Dry-friction reference dynamics.
    pub solref_friction: [f64; 2],
    /// Dry-friction impedance.
    pub solimp_friction: [f64; 5],
    /// Group, only for selection by the user.
    pub group: i32,
    /// Whether the model's `alignfree` applies to this free joint; `None`: as the compiler says.
    pub align: Option<bool>,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

impl Default for JointSpec {
    fn default() -> Self {
        JointSpec {
            name: String::new(),
            kind: JointKind::Hinge,
            pos: Vec3::ZERO,
            axis: Vec3::new(0.0, 0.0, 1.0),
            range: [0.0; 2],
            limited: None,
            actuatorfrcrange: [0.0; 2],
            actuatorfrclimited: None,
            actuatorgravcomp: false,
            margin: 0.0,
            reference: 0.0,
            springref: 0.0,
            springyield: 0.0,
            stiffness: [0.0; 3],
            damping: [0.0; 3],
            springdamper: [0.0; 2],
            armature: 0.0,
            frictionloss: 0.0,
            solref_limit: DEFAULT_SOLREF,
            solimp_limit: DEFAULT_SOLIMP,
            solref_friction: DEFAULT_SOLREF,
            solimp_friction: DEFAULT_SOLIMP,
            group: 0,
            align: None,
            user: Arc::default(),
            origin: None,
        }
    }
}

/// How heavy a geom is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GeomMass {
    /// kg.
    Mass(f64),
    /// kg/m³ (kg/m² for a shell).
    Density(f64),
}

/// A shape fixed to a body.
#[derive(Clone, Debug)]
pub struct GeomSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Shape.
    pub kind: ShapeKind,
    /// MuJoCo's sizes of that shape, m; those of a mesh or height field, and of a shape that is fitted to a mesh, are ignored.
    pub size: Vec3<f64>,
    /// The mesh that it is (`kind` is `Mesh`), or that its shape is fitted to, in whose frame it then stands; possibly empty.
    pub mesh: String,
    /// The height field that it is (`kind` is `HeightField`), or empty.
    pub hfield: String,
    /// Multiplies the size of a shape that is fitted to a mesh.
    pub fitscale: f64,
    /// Position in the body frame (of the mesh's own frame, for a mesh), m.
    pub pos: Vec3<f64>,
    /// Orientation in the body frame, likewise.
    pub quat: Quat<f64>,
    /// Contact type bits.
    pub contype: u32,
    /// Contact affinity bits.
    pub conaffinity: u32,
    /// Dimensions of the contact: 1, 3, 4 or 6.
    pub condim: u32,
    /// Slide, spin and roll friction.
    pub friction: [f64; 3],
    /// Whose parameters win in a contact.
    pub priority: i32,
    /// Weight in mixing parameters.
    pub solmix: f64,
    /// Reference dynamics.
    pub solref: [f64; 2],
    /// Impedance.
    pub solimp: [f64; 5],
    /// Distance at which contacts are detected, m.
    pub margin: f64,
    /// Part of the margin in which contacts carry no force, m.
    pub gap: f64,
    /// Velocity of the surface as contacts see it, in the geom's frame: linear (m/s), and angular about its origin (rad/s).
    pub surfacevel: [f64; 6],
    /// Force with which each contact holds on, N; those of two geoms add up.
    pub adhesion: f64,
    /// The geom feels a surrounding medium as an ellipsoid, and its body does not as a box.
    pub fluid_ellipsoid: bool,
    /// Coefficients of blunt, slender and angular drag, of Kutta and of Magnus lift.
    pub fluidcoef: [f64; 5],
    /// Mass or density.
    pub mass: GeomMass,
    /// Mass spread over the surface.
    pub shellinertia: bool,
    /// Whether it can be seen: rays pass through what cannot.
    pub visible: bool,
    /// Group.
    pub group: i32,
    /// How it looks.
    pub appearance: AppearanceSpec,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

impl Default for GeomSpec {
    fn default() -> Self {
        GeomSpec {
            name: String::new(),
            kind: ShapeKind::Sphere,
            size: Vec3::ZERO,
            mesh: String::new(),
            hfield: String::new(),
            fitscale: 1.0,
            pos: Vec3::ZERO,
            quat: Quat::IDENTITY,
            contype: 1,
            conaffinity: 1,
            condim: 3,
            friction: [1.0, 0.005, 0.0001],
            priority: 0,
            solmix: 1.0,
            solref: DEFAULT_SOLREF,
            solimp: DEFAULT_SOLIMP,
            margin: 0.0,
            gap: 0.0,
            surfacevel: [0.0; 6],
            adhesion: 0.0,
            fluid_ellipsoid: false,
            fluidcoef: [0.5, 0.25, 1.5, 1.0, 1.0],
            mass: GeomMass::Density(1000.0),
            shellinertia: false,
            visible: true,
            group: 0,
            appearance: AppearanceSpec::default(),
            user: Arc::default(),
            origin: None,
        }
    }
}

/// A named frame on a body, with a volume in which sensors feel.
#[derive(Clone, Debug)]
pub struct SiteSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Position in the body frame, m.
    pub pos: Vec3<f64>,
    /// Orientation in the body frame.
    pub quat: Quat<f64>,
    /// Shape of its volume: sphere, capsule, ellipsoid, cylinder, box or mesh.
    pub kind: ShapeKind,
    /// The mesh whose convex hull it is (`kind` is `Mesh`), in the coordinates of its author, or empty.
    pub mesh: String,
    /// Size of that, as a geom's, m; that of a mesh is ignored.
    pub size: [f64; 3],
    /// Group.
    pub group: i32,
    /// How it looks.
    pub appearance: AppearanceSpec,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// A ball of 5 mm, as in MuJoCo.
impl Default for SiteSpec {
    fn default() -> Self {
        SiteSpec {
            name: String::new(),
            pos: Vec3::ZERO,
            quat: Quat::IDENTITY,
            kind: ShapeKind::Sphere,
            mesh: String::new(),
            size: [0.005; 3],
            group: 0,
            appearance: AppearanceSpec::default(),
            user: Arc::default(),
            origin: None,
        }
    }
}

/// What is kept of the past, and how late it is read: MuJoCo's `nsample`, `interp` and `delay`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistorySpec {
    /// How many samples are kept.
    pub nsample: usize,
    /// How they are read between samples.
    pub interp: Interpolation,
    /// How late values arrive, s; needs samples.
    pub delay: f64,
}
