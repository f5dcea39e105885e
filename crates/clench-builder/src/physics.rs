//! Model-wide settings: how to derive what was not said, the physics of the world, and how wide users' own numbers are.

use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_dynamics::model::{Flags, Integrator};

/// When a body's inertia comes from its geoms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InertiaFromGeom {
    /// Where the body has no inertial of its own.
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
    /// A range implies a limit where the author did not say.
    pub autolimits: bool,
    /// Least mass of a moving body, kg; 0 for none.
    pub boundmass: f64,
    /// Least principal moment of a moving body, kg m²; 0 for none.
    pub boundinertia: f64,
    /// Scale all masses and inertias to this total, kg.
    pub settotalmass: Option<f64>,
    /// Repair inertias that break the triangle inequality.
    pub balanceinertia: bool,
    /// When inertia comes from geoms.
    pub inertiafromgeom: InertiaFromGeom,
    /// Geom groups (first, last) that count towards inertia.
    pub inertiagrouprange: [i32; 2],
    /// Move the frame of free bodies to their inertial frame.
    pub alignfree: bool,
    /// Fit shapes to the bounding boxes of meshes, not to their boxes of equivalent inertia.
    pub fitaabb: bool,
    /// Leave out geoms that collide with nothing, and meshes that no other geom has; masses stay.
    pub discardvisual: bool,
    /// How length ranges of actuators are found.
    pub lengthrange: LengthRangeSpec,
    /// Make bodies that no joint moves part of their parents, where that changes no motion and no other element names them.
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
    /// Seconds a step.
    pub timestep: f64,
    /// m/s².
    pub gravity: [f64; 3],
    /// Velocity of the medium, m/s.
    pub wind: [f64; 3],
    /// The magnetic field, which magnetometers measure.
    pub magnetic: [f64; 3],
    /// Density of the medium, kg/m³.
    pub density: f64,
    /// Viscosity of the medium, Pa s.
    pub viscosity: f64,
    /// How velocity and position advance.
    pub integrator: Integrator,
    /// Speed below which trees fall asleep where the flag `sleep` is on, m/s.
    pub sleep_tolerance: f64,
    /// Feature switches.
    pub flags: Flags,
    /// Contact parameters that replace all others (MuJoCo's `override` flag): margin, solref, solimp, friction.
    pub contact_override: Option<ContactOverride>,
    /// Actuator groups that are switched off.
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

/// Which actuators need a length range.
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

/// How length ranges are found where they are needed: MuJoCo's `<compiler><lengthrange/>`, with its defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthRangeSpec {
    /// Which actuators need one.
    pub mode: LengthRangeMode,
    /// A range that rises counts as given.
    pub useexisting: bool,
    /// The range of a limited joint or tendon is the range of its actuator.
    pub uselimit: bool,
    /// Norm of the acceleration that the force causes.
    pub accel: f64,
    /// Largest norm of the force along dofs; 0 for no bound.
    pub maxforce: f64,
    /// Time constant of the fading of velocities, s.
    pub timeconst: f64,
    /// Time step, s; 0 for that of the model.
    pub timestep: f64,
    /// Time simulated in each direction, s.
    pub inttotal: f64,
    /// Time at the end over which the length must have settled, s.
    pub interval: f64,
    /// The share of its range that it may still move by then.
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

/// How many numbers of the user's own the elements of each kind have; `None`: as many as the one that is given most. What an
/// element is not given is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UserWidths {
    /// Of bodies.
    pub body: Option<usize>,
    /// Of joints.
    pub joint: Option<usize>,
    /// Of geoms.
    pub geom: Option<usize>,
    /// Of sites.
    pub site: Option<usize>,
    /// Of cameras.
    pub camera: Option<usize>,
    /// Of tendons.
    pub tendon: Option<usize>,
    /// Of actuators.
    pub actuator: Option<usize>,
    /// Of sensors.
    pub sensor: Option<usize>,
}
