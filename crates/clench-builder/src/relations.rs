//! Elements that refer to others by name: tendons, actuators, equality constraints, contact pairs and keyframes, with
//! MuJoCo's defaults.

use super::element_number::{ElementNumber, NumberDimension, NumberRange, declare_numbers};
use super::{AppearanceSpec, HistorySpec, Origin};
use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{BiasKind, ControlInput, DynamicsKind, GainKind, ParamField};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// An element of the path of a tendon.
#[derive(Clone, Debug, PartialEq)]
pub enum WrapSpec {
    /// A joint of a fixed tendon: its position, times a coefficient.
    Joint {
        /// The joint, a slide or a hinge.
        joint: String,
        /// The coefficient.
        coef: f64,
    },
    /// A site that a spatial tendon passes.
    Site(String),
    /// A sphere, or an infinite cylinder, around which a spatial tendon wraps between two sites.
    Geom {
        /// The geom.
        geom: String,
        /// A site on the side where the tendon must pass. If it is inside the geom, the tendon passes inside too.
        side: Option<String>,
    },
    /// The start of a branch of a spatial tendon, whose length is divided by this.
    Pulley(f64),
}

/// Declares tendons with the fields of the table of element numbers.
macro_rules! declare_tendon {
    ([] joint {$($joint:tt)*} dof {$($dof:tt)*}
    tendon {$(
        $(#[$doc:meta])* $name:ident: $param:ident, $check:ident, $rule:ident, $dimension:ident;
    )*}) => {
        /// A tendon: fixed, a weighted sum of joint positions, or spatial, a string through sites and around geoms.
        /// Both have limits, springs, dampers, friction, inertia and actuators, which depend only on the length and its
        /// gradient.
        #[derive(Clone, Debug)]
        pub struct TendonSpec {
            /// Name, possibly empty.
            pub name: String,
            /// Its path: only joints, or branches that begin and end with a site.
            pub path: Vec<WrapSpec>,
            /// Allowed lengths.
            pub range: [f64; 2],
            /// True if the range limits the tendon; `None`: if `autolimits` and a range is given.
            pub limited: Option<bool>,
            /// Limits of the total actuator force.
            pub actuatorfrcrange: [f64; 2],
            /// True if that range applies; `None` as for `limited`.
            pub actuatorfrclimited: Option<bool>,
            /// Spring stiffness: coefficients of the first, second and third power of the elongation.
            pub stiffness: [f64; 3],
            /// Damping: coefficients of v, v |v| and v³ at the velocity v.
            pub damping: [f64; 3],
            /// Dead band of the spring; `None`: the length at the rest positions of the joints' springs.
            pub springlength: Option<[f64; 2]>,
            /// Limit reference dynamics.
            pub solref_limit: [f64; 2],
            /// Limit impedance.
            pub solimp_limit: [f64; 5],
            /// Dry-friction reference dynamics.
            pub solref_friction: [f64; 2],
            /// Dry-friction impedance.
            pub solimp_friction: [f64; 5],
            /// Its appearance.
            pub appearance: AppearanceSpec,
            /// Radius when drawn, m.
            pub width: f64,
            /// The user's own numbers.
            pub user: Arc<[f64]>,
            /// The source location.
            pub origin: Option<Origin>,
            $($(#[$doc])* pub $name: f64,)*
        }

        impl Default for TendonSpec {
            fn default() -> Self {
                TendonSpec {
                    name: String::new(),
                    path: Vec::new(),
                    range: [0.0; 2],
                    limited: None,
                    actuatorfrcrange: [0.0; 2],
                    actuatorfrclimited: None,
                    stiffness: [0.0; 3],
                    damping: [0.0; 3],
                    springlength: None,
                    solref_limit: DEFAULT_SOLREF,
                    solimp_limit: DEFAULT_SOLIMP,
                    solref_friction: DEFAULT_SOLREF,
                    solimp_friction: DEFAULT_SOLIMP,
                    appearance: AppearanceSpec::default(),
                    width: 0.003,
                    user: Arc::default(),
                    origin: None,
                    $($name: 0.0,)*
                }
            }
        }

        /// The attributes of MJCF in the table that follows, in one literal.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! tendon_attributes {
            () => { concat!($(" ", stringify!($name)),*) };
        }
        declare_numbers! { TendonSpec
            /// The numbers of tendons that reach the parameters unchanged.
            TENDON_NUMBERS numbers numbers_mut: $($name: $param, $check, $rule, $dimension;)* }
    };
}
clench_dynamics::element_numbers!(declare_tendon);

/// The transmission of an actuator.
#[derive(Clone, Debug, PartialEq)]
pub enum TransmissionSpec {
    /// A joint, its axes in the child frame for ball and free joints.
    Joint(String),
    /// A joint, its axes in the parent frame for ball and free joints.
    JointInParent(String),
    /// A tendon.
    Tendon(String),
    /// A site: the gears are a force and a torque along its axes.
    Site(String),
    /// The pose of a site in the frame of another: the gears are directions of position and of rotation in it.
    SiteInFrame {
        /// The moving site.
        site: String,
        /// The reference site.
        reference: String,
    },
    /// A slider on the z axis of a site, connected to a crank's pin by a rod of the actuator's `cranklength`.
    SliderCrank {
        /// The site of the pin.
        crank: String,
        /// The site of the slider's axis.
        slider: String,
    },
    /// The contacts of a body, which share the force equally: it pulls their two sides together.
    Body(String),
}

/// An actuator: force = gain · (control or activation) + bias.
#[derive(Clone, Debug)]
pub struct ActuatorSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Its transmission.
    pub transmission: TransmissionSpec,
    /// The activation dynamics.
    pub dynamics: DynamicsKind,
    /// Parameters of the dynamics.
    pub dynprm: [f64; 10],
    /// Gain as a function of length and velocity.
    pub gain: GainKind,
    /// Parameters of the gain.
    pub gainprm: [f64; 10],
    /// Bias as a function of length and velocity.
    pub bias: BiasKind,
    /// Parameters of the bias.
    pub biasprm: [f64; 10],
    /// Damping ratio of a position servo, resolved by the builder into `biasprm[2]`.
    pub dampratio: Option<f64>,
    /// The control range as a fraction of the joint or tendon range; needs a limited target.
    pub inheritrange: f64,
    /// Scaling of the force onto the transmission's axes.
    pub gear: [f64; 6],
    /// Coefficients of linear, quadratic and cubic damping added to the joint or tendon, times the square of the gear.
    pub damping: [f64; 3],
    /// Inertia added to the joint or tendon, likewise.
    pub armature: f64,
    /// The storage and the delay of controls.
    pub history: HistorySpec,
    /// Length of the rod of a slider-crank, m.
    pub cranklength: f64,
    /// Range of the transmission's length, used by muscles; not given unless it is ascending.
    pub lengthrange: [f64; 2],
    /// Allowed controls.
    pub ctrlrange: [f64; 2],
    /// True if the controls are clamped; `None`: if `autolimits` and a range is given.
    pub ctrllimited: Option<bool>,
    /// Allowed velocity setpoints of a PID controller; they apply if the range is ascending.
    pub velrange: [f64; 2],
    /// Allowed feedforward of a PID controller, likewise.
    pub ffrange: [f64; 2],
    /// The controls of a PID controller or DC motor, in the order of [`ControlInput`]; `None`: the default ones,
    /// position and velocity, or a motor's voltage. Others have one control.
    pub inputs: Option<Vec<ControlInput>>,
    /// Allowed forces.
    pub forcerange: [f64; 2],
    /// True if the force is clamped; `None` as for `ctrllimited`.
    pub forcelimited: Option<bool>,
    /// Allowed activations.
    pub actrange: [f64; 2],
    /// True if the activations are clamped; `None` as for `ctrllimited`.
    pub actlimited: Option<bool>,
    /// Number of activations; `None`: that of the dynamics. Dynamics of the user may have any number.
    pub actdim: Option<usize>,
    /// True if the activation at the end of the step is used.
    pub actearly: bool,
    /// Group.
    pub group: i32,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// The anchor of a connect or weld.
#[derive(Clone, Debug, PartialEq)]
pub enum ConnectAnchor {
    /// Two bodies (the second may be the world, by the empty name) and the anchor in the first body's frame. The
    /// builder computes the second anchor from the initial configuration.
    Bodies {
        /// First body.
        body1: String,
        /// Second body.
        body2: String,
        /// Anchor in the first body's frame for connect, in the second body's for weld, m.
        anchor: Vec3<f64>,
    },
    /// Two sites whose frames must coincide.
    Sites {
        /// First site.
        site1: String,
        /// Second site.
        site2: String,
    },
}

/// The relation that an equality enforces.
#[derive(Clone, Debug, PartialEq)]
pub enum EqualityKind {
    /// Two points coincide.
    Connect(ConnectAnchor),
    /// Two frames coincide.
    Weld {
        /// The two bodies or sites.
        anchor: ConnectAnchor,
        /// Pose of the second body relative to the first; `None`: as in the initial configuration.
        relpose: Option<(Vec3<f64>, Quat<f64>)>,
        /// Length that scales rotations against translations.
        torquescale: f64,
    },
    /// One joint follows a quartic of another (or a constant): y − y₀ = Σ coef_k (x − x₀)^k.
    Joint {
        /// The follower joint.
        joint1: String,
        /// The leader joint, if any.
        joint2: Option<String>,
        /// Coefficients, constant first.
        polycoef: [f64; 5],
    },
    /// One tendon follows a quartic of another (or a constant).
    Tendon {
        /// The follower tendon.
        tendon1: String,
        /// The leader tendon, if any.
        tendon2: Option<String>,
        /// Coefficients, constant first.
        polycoef: [f64; 5],
    },
}

impl EqualityKind {
    /// Returns the two bodies or sites of a connect or weld.
    pub(super) fn anchor(&self) -> Option<&ConnectAnchor> {
        match self {
            EqualityKind::Connect(anchor) | EqualityKind::Weld { anchor, .. } => Some(anchor),
            EqualityKind::Joint { .. } | EqualityKind::Tendon { .. } => None,
        }
    }
}

/// An equality constraint.
#[derive(Clone, Debug)]
pub struct EqualitySpec {
    /// Name, possibly empty.
    pub name: String,
    /// The relation that it enforces.
    pub kind: EqualityKind,
    /// True if initially active.
    pub active: bool,
    /// Reference dynamics.
    pub solref: [f64; 2],
    /// Impedance.
    pub solimp: [f64; 5],
    /// The source location.
    pub origin: Option<Origin>,
}

/// A geom pair that always collides. Parameters that are `None` are mixed from its geoms.
#[derive(Clone, Debug, Default)]
pub struct PairSpec {
    /// Name, possibly empty.
    pub name: String,
    /// First geom.
    pub geom1: String,
    /// Second geom.
    pub geom2: String,
    /// Dimensions of the contact.
    pub condim: Option<u32>,
    /// Friction: two slides, spin, two rolls.
    pub friction: Option<[f64; 5]>,
    /// Reference dynamics.
    pub solref: Option<[f64; 2]>,
    /// Reference dynamics of the friction dimensions; `None`: as `solref`.
    pub solreffriction: Option<[f64; 2]>,
    /// Impedance.
    pub solimp: Option<[f64; 5]>,
    /// Margin, m.
    pub margin: Option<f64>,
    /// Gap, m.
    pub gap: Option<f64>,
    /// Adhesive force of each contact, N.
    pub adhesion: Option<f64>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// Two bodies that never collide.
#[derive(Clone, Debug, Default)]
pub struct ExcludeSpec {
    /// Name, possibly empty.
    pub name: String,
    /// First body.
    pub body1: String,
    /// Second body.
    pub body2: String,
    /// The source location.
    pub origin: Option<Origin>,
}

/// The part of a stored state that belongs to one element.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframePart {
    /// The element.
    pub element: KeyframeElement,
    /// Its part of `qpos`, `ctrl` or `mocap_pos`; empty for the initial state.
    pub first: Vec<f64>,
    /// Its part of `qvel`, `act` or `mocap_quat`; empty for the initial state.
    pub second: Vec<f64>,
    /// Its part of `plastic`; empty for the initial state.
    pub plastic: Vec<f64>,
}

/// An element with a part of the state, by its index in the model, with bodies in the model's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyframeElement {
    /// A joint, with positions and velocities.
    Joint(usize),
    /// An actuator, with controls and activations.
    Actuator(usize),
    /// A mocap body, with a position and an orientation.
    Mocap(usize),
    /// A tendon, whose spring may yield.
    Tendon(usize),
}

/// A stored state; `None` fields are as in the initial state.
#[derive(Clone, Debug, Default)]
pub struct KeyframeSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Time, s.
    pub time: f64,
    /// Positions (nq).
    pub qpos: Option<Vec<f64>>,
    /// Velocities (nv).
    pub qvel: Option<Vec<f64>>,
    /// Activations (na).
    pub act: Option<Vec<f64>>,
    /// Rest positions of yielding springs (nplastic).
    pub plastic: Option<Vec<f64>>,
    /// Controls (nu).
    pub ctrl: Option<Vec<f64>>,
    /// Mocap positions (3 nmocap).
    pub mocap_pos: Option<Vec<f64>>,
    /// Mocap orientations (4 nmocap).
    pub mocap_quat: Option<Vec<f64>>,
    /// Parts of single elements; they override the fields above.
    pub parts: Vec<KeyframePart>,
    /// The source location.
    pub origin: Option<Origin>,
}
