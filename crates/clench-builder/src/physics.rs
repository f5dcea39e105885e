//! Model-wide settings: the derivation of missing fields, the physics of the world, and the number of users' own
//! numbers.

use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{Flags, Integrator};

/// The condition for computing a body's inertia from its geoms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InertiaFromGeom {
    /// If the body has no inertial of its own.
    #[default]
    Auto,
    /// Always, ignoring inertials.
    Always,
    /// Never.
    Never,
}

/// MuJoCo's `<compiler>` settings that act on the model rather than on its notation.
#[derive(Clone, Debug, PartialEq)]
pub struct CompilerSpec {
    /// A range implies a limit if the author did not specify it.
    pub autolimits: bool,
    /// Minimum mass of a moving body, kg; 0 for none.
    pub boundmass: f64,
    /// Minimum principal moment of a moving body, kg m²; 0 for none.
    pub boundinertia: f64,
    /// Scale all masses and inertias to this total, kg.
    pub settotalmass: Option<f64>,
    /// Repair inertias that violate the triangle inequality.
    pub balanceinertia: bool,
    /// The condition for computing inertia from geoms.
    pub inertiafromgeom: InertiaFromGeom,
    /// Geom groups (first, last) that count towards inertia.
    pub inertiagrouprange: [i32; 2],
    /// Move the frame of free bodies to their inertial frame.
    pub alignfree: bool,
    /// Fit shapes to the bounding boxes of meshes, not to their boxes of equivalent inertia.
    pub fitaabb: bool,
    /// Omit geoms that collide with nothing, and meshes that no other geom uses; masses stay.
    pub discardvisual: bool,
    /// The search for length ranges of actuators.
    pub lengthrange: LengthRangeSpec,
    /// Fuse bodies without joints with their parents, if that does not change the motion and no other element names
    /// them.
    pub fusestatic: bool,
}

impl Default for CompilerSpec {
    fn default() -> Self {
        CompilerSpec {
            autolimits: true,
            boundmass: 0.0,
            boundinertia: 0.0,
            settotalmass: None,
            balanceinertia: false,
            inertiafromgeom: InertiaFromGeom::Auto,
            inertiagrouprange: [0, 5],
            alignfree: false,
            fitaabb: false,
            discardvisual: false,
            lengthrange: LengthRangeSpec::default(),
            fusestatic: false,
        }
    }
}

/// Time step, medium and feature flags, with MuJoCo's defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsSpec {
    /// Time step, s.
    pub timestep: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: [f64; 3],
    /// Velocity of the medium, m/s.
    pub wind: [f64; 3],
    /// The magnetic field, measured by magnetometers.
    pub magnetic: [f64; 3],
    /// Density of the medium, kg/m³.
    pub density: f64,
    /// Viscosity of the medium, Pa s.
    pub viscosity: f64,
    /// The integrator.
    pub integrator: Integrator,
    /// Speed below which trees fall asleep with the flag `sleep`, m/s.
    pub sleep_tolerance: f64,
    /// Feature switches.
    pub flags: Flags,
    /// Contact parameters that replace all others (MuJoCo's `override` flag): margin, solref, solimp, friction.
    pub contact_override: Option<ContactOverride>,
    /// Disabled actuator groups.
    pub disabled_actuator_groups: Vec<u32>,
}

/// One set of contact parameters for every contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOverride {
    /// Detection margin, m.
    pub margin: f64,
    /// Reference dynamics.
    pub solref: [f64; 2],
    /// Impedance.
    pub solimp: [f64; 5],
    /// Friction: two slides, spin, two rolls.
    pub friction: [f64; 5],
}

/// MuJoCo's defaults of its `o_margin`, `o_solref`, `o_solimp` and `o_friction`.
impl Default for ContactOverride {
    fn default() -> Self {
        ContactOverride {
            margin: 0.0,
            solref: DEFAULT_SOLREF,
            solimp: DEFAULT_SOLIMP,
            friction: [1.0, 1.0, 0.005, 0.0001, 0.0001],
        }
    }
}

impl Default for PhysicsSpec {
    fn default() -> Self {
        PhysicsSpec {
            timestep: 0.002,
            gravity: [0.0, 0.0, -9.81],
            wind: [0.0; 3],
            magnetic: [0.0, -0.5, 0.0],
            density: 0.0,
            viscosity: 0.0,
            sleep_tolerance: 1e-3,
            integrator: Integrator::Euler,
            flags: Flags::default(),
            contact_override: None,
            disabled_actuator_groups: Vec::new(),
        }
    }
}

/// The actuators that need a length range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthRangeMode {
    /// None.
    None,
    /// The ranges of actuators whose gain or bias is a muscle's.
    #[default]
    Muscle,
    /// The ranges of actuators whose gain or bias is a muscle's or the user's.
    MuscleUser,
    /// All.
    All,
}

/// The search for length ranges: MuJoCo's `<compiler><lengthrange/>`, with its defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthRangeSpec {
    /// The actuators that need a range.
    pub mode: LengthRangeMode,
    /// An ascending range counts as given.
    pub useexisting: bool,
    /// The range of a limited joint or tendon is the range of its actuator.
    pub uselimit: bool,
    /// Norm of the acceleration that the force causes.
    pub accel: f64,
    /// Maximum norm of the force along dofs; 0 for no limit.
    pub maxforce: f64,
    /// Time constant of the decay of velocities, s.
    pub timeconst: f64,
    /// Time step, s; 0 for that of the model.
    pub timestep: f64,
    /// Time simulated in each direction, s.
    pub inttotal: f64,
    /// Time at the end in which the length must have converged, s.
    pub interval: f64,
    /// Fraction of its range by which it may still move in that time.
    pub tolrange: f64,
}

impl Default for LengthRangeSpec {
    fn default() -> Self {
        LengthRangeSpec {
            mode: LengthRangeMode::Muscle,
            useexisting: true,
            uselimit: false,
            accel: 20.0,
            maxforce: 0.0,
            timeconst: 1.0,
            timestep: 0.01,
            inttotal: 10.0,
            interval: 2.0,
            tolrange: 0.05,
        }
    }
}

/// The user's own numbers per element of each kind; `None`: the maximum that any element gives. Missing numbers are
/// zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UserWidths {
    /// For bodies.
    pub body: Option<usize>,
    /// For joints.
    pub joint: Option<usize>,
    /// For geoms.
    pub geom: Option<usize>,
    /// For sites.
    pub site: Option<usize>,
    /// For cameras.
    pub camera: Option<usize>,
    /// For tendons.
    pub tendon: Option<usize>,
    /// For actuators.
    pub actuator: Option<usize>,
    /// For sensors.
    pub sensor: Option<usize>,
}
