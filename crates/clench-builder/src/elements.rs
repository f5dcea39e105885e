//! Bodies and the elements on them, with MuJoCo's defaults.

use super::element_number::{ElementNumber, NumberDimension, NumberRange, declare_numbers};
use super::{AppearanceSpec, CameraSpec, CompilerSpec, LightSpec, Origin};
use clench_collide::ShapeKind;
use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{Interpolation, JointKind, ParamField, SleepPolicy};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// The default maximum number of constraints added at run time.
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
    /// The pose as written, if frames of the file transformed it to `pos` and `quat`.
    pub written: Option<(Vec3<f64>, Quat<f64>)>,
    /// Mass properties, if the author gave them.
    pub inertial: Option<InertialSpec>,
    /// True if it is moved by the user, not by forces; child of the world, without joints.
    pub mocap: bool,
    /// If a body only slides along coordinate axes, MuJoCo scales its constraints by its mass in every direction. With
    /// this flag they are scaled as those of any other body, by the mean over all directions (`simple="false"`).
    pub never_simple: bool,
    /// True if `CompilerSpec::fusestatic` must not fuse it with its parent.
    pub never_fused: bool,
    /// The sleep policy of the tree of which this body is the root.
    pub sleep: SleepPolicy,
    /// Fraction of the body's weight that is compensated. As in MuJoCo, negative fractions count only if some body's is
    /// positive.
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
    /// The settings of the model that it was attached from, which determine its inertia and its frame; `None` for those
    /// of the builder.
    pub compiler: Option<Arc<CompilerSpec>>,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// Mass properties given by the author.
#[derive(Clone, Debug)]
pub struct InertialSpec {
    /// Centre of mass in the body frame, m.
    pub pos: Vec3<f64>,
    /// Orientation of the inertial frame in the body frame (ignored with a full inertia).
    pub quat: Quat<f64>,
    /// Mass, kg.
    pub mass: f64,
    /// Rotational inertia.
    pub inertia: InertiaSpec,
    /// The source location.
    pub origin: Option<Origin>,
}

/// Rotational inertia about the centre of mass, kg m².
#[derive(Clone, Copy, Debug)]
pub enum InertiaSpec {
    /// Principal moments in the inertial frame.
    Diagonal([f64; 3]),
    /// The elements xx, yy, zz, xy, xz, yz in the body frame.
    Full([f64; 6]),
}

/// Declares joints with the fields of the table of element numbers.
macro_rules! declare_joint {
    ([]
    joint {$(
        $(#[$joint_doc:meta])* $joint:ident: $jp:ident, $jc:ident, $jr:ident, $jd:ident;
    )*}
    dof {$(
        $(#[$dof_doc:meta])* $dof:ident: $dp:ident, $dc:ident, $dr:ident, $dd:ident;
    )*}
    tendon {$($tendon:tt)*}) => {
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
            /// Allowed positions, rad or m; for a ball joint (0, maximum angle).
            pub range: [f64; 2],
            /// True if the range limits the joint; `None`: if `autolimits` and a range is given.
            pub limited: Option<bool>,
            /// Limits of the total actuator force, N or N m.
            pub actuatorfrcrange: [f64; 2],
            /// True if that range applies; `None` as for `limited`.
            pub actuatorfrclimited: Option<bool>,
            /// True if gravity compensation counts as actuation.
            pub actuatorgravcomp: bool,
            /// Position in the initial configuration.
            pub reference: f64,
            /// Position at which the spring is at rest.
            pub springref: f64,
            /// Coefficients of the spring force a x + b x² + c x³ at a displacement x, N/m or N m/rad.
            pub stiffness: [f64; 3],
            /// Coefficients of the damping force a v + b v |v| + c v³ at a velocity v, N s/m or N m s/rad.
            pub damping: [f64; 3],
            /// Time constant and damping ratio from which the linear stiffness and damping are derived, if positive.
            pub springdamper: [f64; 2],
            /// Reference dynamics of the limit (solref).
            pub solref_limit: [f64; 2],
            /// Impedance of the limit (solimp).
            pub solimp_limit: [f64; 5],
            /// Reference dynamics of dry friction (solref).
            pub solref_friction: [f64; 2],
            /// Impedance of dry friction (solimp).
            pub solimp_friction: [f64; 5],
            /// Group, only for selection by the user.
            pub group: i32,
            /// True if the model's `alignfree` applies to this free joint; `None`: the compiler's setting.
            pub align: Option<bool>,
            /// The user's own numbers.
            pub user: Arc<[f64]>,
            /// The source location.
            pub origin: Option<Origin>,
            $($(#[$joint_doc])* pub $joint: f64,)*
            $($(#[$dof_doc])* pub $dof: f64,)*
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
                    reference: 0.0,
                    springref: 0.0,
                    stiffness: [0.0; 3],
                    damping: [0.0; 3],
                    springdamper: [0.0; 2],
                    solref_limit: DEFAULT_SOLREF,
                    solimp_limit: DEFAULT_SOLIMP,
                    solref_friction: DEFAULT_SOLREF,
                    solimp_friction: DEFAULT_SOLIMP,
                    group: 0,
                    align: None,
                    user: Arc::default(),
                    origin: None,
                    $($joint: 0.0,)*
                    $($dof: 0.0,)*
                }
            }
        }

        /// The attributes of MJCF in the two tables that follow, in one literal.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! joint_attributes {
            () => { concat!($(" ", stringify!($joint),)* $(" ", stringify!($dof)),*) };
        }
        declare_numbers! { JointSpec
            /// The numbers of joints that reach the parameters unchanged.
            JOINT_NUMBERS joint_numbers joint_numbers_mut: $($joint: $jp, $jc, $jr, $jd;)* }
        declare_numbers! { JointSpec
            /// Those of joints that reach the parameters of each of their dofs.
            DOF_NUMBERS dof_numbers dof_numbers_mut: $($dof: $dp, $dc, $dr, $dd;)* }
    };
}
clench_dynamics::element_numbers!(declare_joint);

/// The mass of a geom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GeomMass {
    /// Mass, kg.
    Mass(f64),
    /// Density, kg/m³ (kg/m² for a shell).
    Density(f64),
}

/// A shape fixed to a body.
#[derive(Clone, Debug)]
pub struct GeomSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Shape.
    pub kind: ShapeKind,
    /// MuJoCo's sizes of that shape, m; those of a mesh or height field, and of a shape that is fitted to a mesh, are
    /// ignored.
    pub size: Vec3<f64>,
    /// The mesh of a geom of kind `Mesh`, or the mesh that its shape is fitted to and in whose frame it is; possibly
    /// empty.
    pub mesh: String,
    /// The height field of a geom of kind `HeightField`, or empty.
    pub hfield: String,
    /// The factor of the size of a shape that is fitted to a mesh.
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
    /// Priority of its contact parameters.
    pub priority: i32,
    /// Weight in mixing parameters.
    pub solmix: f64,
    /// Reference dynamics of its contacts (solref).
    pub solref: [f64; 2],
    /// Impedance of its contacts (solimp).
    pub solimp: [f64; 5],
    /// Distance at which contacts are detected, m.
    pub margin: f64,
    /// Part of the margin in which contacts carry no force, m.
    pub gap: f64,
    /// Velocity of the surface in contacts, in the geom's frame: linear (m/s), and angular about its origin (rad/s).
    pub surfacevel: [f64; 6],
    /// Adhesive force of each contact, N; those of two geoms add up.
    pub adhesion: f64,
    /// True if fluid forces act on the geom as an ellipsoid, and not on its body as a box.
    pub fluid_ellipsoid: bool,
    /// Coefficients of blunt, slender and angular drag, of Kutta and of Magnus lift.
    pub fluidcoef: [f64; 5],
    /// Mass or density.
    pub mass: GeomMass,
    /// True if the mass is on the surface.
    pub shellinertia: bool,
    /// True if it is visible: rays pass through invisible geoms.
    pub visible: bool,
    /// Group.
    pub group: i32,
    /// Its appearance.
    pub appearance: AppearanceSpec,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
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

/// A named frame on a body, with a volume for sensors.
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
    /// The mesh whose convex hull is the volume (`kind` is `Mesh`), in the coordinates of its author, or empty.
    pub mesh: String,
    /// Size of the volume, as a geom's, m; ignored for a mesh.
    pub size: [f64; 3],
    /// Group.
    pub group: i32,
    /// Its appearance.
    pub appearance: AppearanceSpec,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// A sphere of 5 mm radius, as in MuJoCo.
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

/// The storage and the delay of past values: MuJoCo's `nsample`, `interp` and `delay`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistorySpec {
    /// The number of samples.
    pub nsample: usize,
    /// The interpolation between samples.
    pub interp: Interpolation,
    /// The delay of values, s; needs samples.
    pub delay: f64,
}
