//! Elements that name others: tendons, actuators, equality constraints, contact pairs and keyframes, with MuJoCo's defaults.

use super::{AppearanceSpec, HistorySpec, Origin};
use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{BiasKind, ControlInput, DynamicsKind, GainKind};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// What a tendon is made of, or passes.
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
    /// A sphere, or a cylinder without ends, that a spatial tendon goes around between two sites.
    Geom {
        /// The geom.
        geom: String,
        /// A site on the side where the tendon has to pass. If it is inside the geom, so has the tendon.
        side: Option<String>,
    },
    /// Starts a branch of a spatial tendon, whose length counts divided by this.
    Pulley(f64),
}

/// A tendon: fixed, a weighted sum of joint positions, or spatial, a string through sites and around geoms. What follows from its
/// length and its gradient is the same for both: limits, springs, dampers, friction, inertia, actuators.
#[derive(Clone, Debug)]
pub struct TendonSpec {
    /// Name, possibly empty.
    pub name: String,
    /// What it is made of: joints alone, or branches that begin and end with a site.
    pub path: Vec<WrapSpec>,
    /// Allowed lengths.
    pub range: [f64; 2],
    /// Whether the range limits the tendon; `None`: if `autolimits` and a range is given.
    pub limited: Option<bool>,
    /// Limits of the total actuator force.
    pub actuatorfrcrange: [f64; 2],
    /// Whether that range applies; `None` as for `limited`.
    pub actuatorfrclimited: Option<bool>,
    /// Distance at which the limit constraint appears.
    pub margin: f64,
    /// Spring stiffness: coefficients of the force's first, second and third power of the stretch.
    pub stiffness: [f64; 3],
    /// Damping: coefficients of v, v |v| and v³ at the velocity v.
    pub damping: [f64; 3],
    /// Inertia of changes of the length, for a tendon that goes around no geom.
    pub armature: f64,
    /// Dead band of the spring; `None`: the length where the springs of joints rest.
    pub springlength: Option<[f64; 2]>,
    /// Stretch at which the spring yields, so that its dead band follows; 0 where it never does.
    pub springyield: f64,
    /// Dry friction.
    pub frictionloss: f64,
    /// Limit reference dynamics.
    pub solref_limit: [f64; 2],
    /// Limit impedance.
    pub solimp_limit: [f64; 5],
    /// Dry-friction reference dynamics.
    pub solref_friction: [f64; 2],
    /// Dry-friction impedance.
    pub solimp_friction: [f64; 5],
    /// How it looks.
    pub appearance: AppearanceSpec,
    /// Radius with which it is drawn, m.
    pub width: f64,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
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
            margin: 0.0,
            stiffness: [0.0; 3],
            damping: [0.0; 3],
            armature: 0.0,
            springlength: None,
            springyield: 0.0,
            frictionloss: 0.0,
            solref_limit: DEFAULT_SOLREF,
            solimp_limit: DEFAULT_SOLIMP,
            solref_friction: DEFAULT_SOLREF,
            solimp_friction: DEFAULT_SOLIMP,
            appearance: AppearanceSpec::default(),
            width: 0.003,
            user: Arc::default(),
            origin: None,
        }
    }
}

/// What an actuator pulls on.
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
        /// The site that moves.
        site: String,
        /// The site in whose frame it does.
        reference: String,
    },
    /// A slider on the axis z of a site, which a rod of the actuator's `cranklength` joins to a crank's pin.
    SliderCrank {
        /// The site of the pin.
        crank: String,
        /// The site of the slider's axis.
        slider: String,
    },
    /// The contacts of a body, which share the force equally: it draws their two sides together.
    Body(String),
}

/// An actuator: force = gain · (control or activation) + bias.
#[derive(Clone, Debug)]
pub struct ActuatorSpec {
    /// Name, possibly empty.
    pub name: String,
    /// What it pulls on.
    pub transmission: TransmissionSpec,
    /// How the control becomes an activation.
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
    /// Share of the joint or tendon range that the control range takes; needs a limited target.
    pub inheritrange: f64,
    /// Scaling of the force onto the transmission's axes.
    pub gear: [f64; 6],
    /// Coefficients of linear, quadratic and cubic damping that the joint or tendon gets, times the square of the gear.
    pub damping: [f64; 3],
    /// Inertia that the joint or tendon gets, likewise.
    pub armature: f64,
    /// Which past controls are kept, and how late they arrive.
    pub history: HistorySpec,
    /// Length of the rod of a slider-crank, m.
    pub cranklength: f64,
    /// Lengths between which the transmission can be, of use to muscles; where they do not rise they are not given.
    pub lengthrange: [f64; 2],
    /// Allowed controls.
    pub ctrlrange: [f64; 2],
    /// Whether it applies; `None`: if `autolimits` and a range is given.
    pub ctrllimited: Option<bool>,
    /// Allowed velocity setpoints of a PID controller; they apply where the range rises.
    pub velrange: [f64; 2],
    /// Allowed feedforward of a PID controller, likewise.
    pub ffrange: [f64; 2],
    /// The controls of a PID controller or DC motor, in the order of [`ControlInput`]; `None`: the usual ones, position and
    /// velocity, or a motor's voltage. Others have one control.
    pub inputs: Option<Vec<ControlInput>>,
    /// Allowed forces.
    pub forcerange: [f64; 2],
    /// Whether it applies; `None` as for `ctrllimited`.
    pub forcelimited: Option<bool>,
    /// Allowed activations.
    pub actrange: [f64; 2],
    /// Whether it applies; `None` as for `ctrllimited`.
    pub actlimited: Option<bool>,
    /// Number of activations; `None`: as many as the dynamics has. Dynamics of the user may have any number.
    pub actdim: Option<usize>,
    /// Use the activation as of the end of the step.
    pub actearly: bool,
    /// Group.
    pub group: i32,
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// Where a connect or weld holds its bodies together.
#[derive(Clone, Debug, PartialEq)]
pub enum ConnectAnchor {
    /// Two bodies (the second may be the world, by the empty name) and the anchor in the first body's frame; the
    /// builder computes the second anchor from the initial configuration.
    Bodies {
        /// First body.
        body1: String,
        /// Second body.
        body2: String,
        /// Anchor in the first body's frame for connect, in the second body's for weld, m.
        anchor: Vec3<f64>,
    },
    /// Two sites whose frames are to coincide.
    Sites {
        /// First site.
        site1: String,
        /// Second site.
        site2: String,
    },
}

/// What an equality keeps equal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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
        /// The joint that follows.
        joint1: String,
        /// The joint that leads, if any.
        joint2: Option<String>,
        /// Coefficients, constant first.
        polycoef: [f64; 5],
    },
    /// One tendon follows a quartic of another (or a constant).
    Tendon {
        /// The tendon that follows.
        tendon1: String,
        /// The tendon that leads, if any.
        tendon2: Option<String>,
        /// Coefficients, constant first.
        polycoef: [f64; 5],
    },
}

impl EqualityKind {
    /// The two bodies or sites, where it holds such.
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
    /// What it keeps equal.
    pub kind: EqualityKind,
    /// On in the initial state.
    pub active: bool,
    /// Reference dynamics.
    pub solref: [f64; 2],
    /// Impedance.
    pub solimp: [f64; 5],
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// A geom pair that always collides; what is `None` is mixed from its geoms.
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
    /// Force with which each contact holds on, N.
    pub adhesion: Option<f64>,
    /// Where it was written.
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
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// What a stored state says of one element.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframePart {
    /// Which one.
    pub element: KeyframeElement,
    /// Its part of `qpos`, `ctrl` or `mocap_pos`; empty as in the initial state.
    pub first: Vec<f64>,
    /// Its part of `qvel`, `act` or `mocap_quat`; empty as in the initial state.
    pub second: Vec<f64>,
    /// Its part of `plastic`; empty as in the initial state.
    pub plastic: Vec<f64>,
}

/// An element that has a part of the state, by its number among those of the model, bodies being in the model's order.
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

/// A stored state; what is `None` is as in the initial state.
#[derive(Clone, Debug, Default)]
pub struct KeyframeSpec {
    /// Name, possibly empty.
    pub name: String,
    /// s.
    pub time: f64,
    /// Positions (nq).
    pub qpos: Option<Vec<f64>>,
    /// Velocities (nv).
    pub qvel: Option<Vec<f64>>,
    /// Activations (na).
    pub act: Option<Vec<f64>>,
    /// Where springs that yield rest (nplastic).
    pub plastic: Option<Vec<f64>>,
    /// Controls (nu).
    pub ctrl: Option<Vec<f64>>,
    /// Mocap positions (3 nmocap).
    pub mocap_pos: Option<Vec<f64>>,
    /// Mocap orientations (4 nmocap).
    pub mocap_quat: Option<Vec<f64>>,
    /// What is said of single elements, over all that.
    pub parts: Vec<KeyframePart>,
    /// Where it was written.
    pub origin: Option<Origin>,
}
