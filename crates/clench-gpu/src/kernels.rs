//! The kernels: which texts each is made of, and the constants that stand before them.
//!
//! A kernel is a file in `kernels/` with an entry point, and the files that hold what it calls. WGSL has no modules: the texts
//! are put one after the other, behind the constants of the model. Loops run over tables; nothing is unrolled for a model.

use crate::fields::Fields;
use crate::layout::Layout;
use crate::precision::{Texts, words};
use crate::solver_memory::SolverMemory;
use crate::tables::{NONE, Tables};
use std::collections::HashSet;
use std::fmt::Write;

/// Workgroups in a row, where each has an environment: a dispatch has no more than 65,535 along an axis.
pub(crate) const GRID: u32 = 32_768;

/// Threads of a team.
pub(crate) const TEAM: u32 = 8;

/// Who works on an environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Workers {
    /// One thread.
    Thread,
    /// A team of threads, each in a workgroup with those of other environments.
    Team,
    /// The threads of the narrow phase, each in a workgroup with those of other environments.
    NarrowPhase,
    /// A thread for each ray of its sensors, likewise; where there are more than [`GRID`], each follows several.
    Rays,
    /// One workgroup.
    Workgroup,
}

impl Workers {
    /// Threads of a workgroup side by side. Where each has an environment: a subgroup on most cards. Where all have one: four for each row of a tile of H
    /// (with half as many a card took a tenth longer).
    const fn threads(self) -> u32 {
        match self {
            Workers::Thread | Workers::Team | Workers::NarrowPhase | Workers::Rays => 32,
            Workers::Workgroup => 64,
        }
    }
}

/// A kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernel {
    /// Its entry point.
    pub entry: &'static str,
    /// Who works on an environment.
    pub workers: Workers,
    /// What it is made of, besides what all have.
    texts: &'static [&'static str],
}

macro_rules! texts {
    ($($name:literal),*) => { &[$(include_str!(concat!("kernels/", $name, ".wgsl"))),*] };
}

/// What all kernels have.
const COMMON: &[&str] = texts!["memory", "math"];

macro_rules! kernels {
    ($($(#[$doc:meta])* $constant:ident = $entry:literal, $workers:ident: $($name:literal),*;)*) => {
        $($(#[$doc])* pub(crate) const $constant: Kernel = Kernel {
            entry: $entry,
            workers: Workers::$workers,
            texts: texts![$($name),*],
        };)*
    };
}

kernels! {
    /// Puts environments into the initial state.
    RESTART = "restart", Thread: "restart";
    /// Poses, spatial inertias, the mass matrix and its factor, tendons and moment arms of actuators.
    POSITIONS = "positions", Team: "team", "kinematics", "com", "tree", "substitution", "chains", "wrap", "tendon",
        "outputs", "transmission", "articulated", "outer", "mass_factor", "inertia";
    /// Which pairs are near.
    BROAD_PHASE = "broad_phase", Team: "team", "broad_phase";
    /// Where near pairs touch.
    NARROW_PHASE = "narrow_phase", NarrowPhase: "near", "shape_data", "contact_pool", "plane", "plane_mesh", "round", "cylinder", "penetration", "box_round",
        "outline", "convex/body", "convex/hull", "convex/cylinder_polyhedron", "convex/cylinders", "convex/pair", "convex/simplex", "convex/refine", "convex/gjk", "convex/polytope", "convex/epa", "convex/feature", "convex/clipping", "convex/patch", "convex/terrain/prism", "convex/terrain/grid", "convex/terrain/bounds", "convex/terrain/manifold", "convex/terrain/face_clip", "convex/terrain/terrain", "convex/convex", "box_box", "narrow_phase";
    /// Contacts.
    CONTACTS = "contacts", Team: "team", "near", "contacts";
    /// Smooth forces and the acceleration they cause.
    FORCES = "forces", Team: "team", "tree", "substitution", "chains", "velocity", "wrap", "tendon_armature", "adhesive", "outputs", "adhesion", "ellipsoid", "spring", "passive", "tendon_forces", "muscle",
        "dc_motor", "activation", "setpoint", "circuit", "history", "gain", "orientation", "actuation", "forces";
    /// Which constraints act, and how soft they are.
    CONSTRAINTS = "constraints", Workgroup: "group", "softness", "chains", "coordinate", "held", "equalities", "adhesive", "constraints";
    /// Their Jacobians.
    ASSEMBLE = "assemble", Workgroup: "group", "chains", "coordinate", "held", "softness", "exact", "assembly";
    /// The convex problem.
    SOLVE = "solve", Workgroup: "group", "mass", "costs", "elliptic", "hessian", "tiles", "cholesky", "iterate", "line_search", "noslip", "newton", "precondition", "substitution", "cg", "descent";
    /// The duality gap that it has left, where somebody asks.
    GAP = "gap", Team: "team", "tree", "substitution", "articulated", "mass_factor", "gap";
    /// Where cameras are, where somebody asks.
    CAMERAS = "cameras", Thread: "cameras";
    /// Accelerations of bodies, forces between them and the energy, where somebody asks.
    BODY_FORCES = "body_forces", Thread: "chains", "held", "tendon_forces", "wrap", "adhesive", "wrench", "external", "spring", "energy", "body_forces";
    /// What rays of sensors meet, where somebody asks.
    RAYS = "rays", Rays: "chord", "optics", "shape_data", "rays/primitives", "rays/triangles", "rays/terrain", "rays/rays";
    /// What sensors measure, where somebody asks.
    SENSORS = "sensors", Thread: "chains", "chord", "site_volume", "adhesive", "wrench", "contact_sensor", "distance_sensor", "clock", "due", "history", "sensor_delay", "optics", "sensors";
    /// Whether what they found is within bounds.
    VERDICT = "verdict", Team: "team", "verdict", "judge";
    /// The next state, by semi-implicit Euler.
    EULER = "euler", Team: "team", "tree", "substitution", "articulated", "dc_motor", "activation", "verdict", "plastic", "clock", "due", "history_push", "outputs", "integrate", "euler";
    /// The same, implicit in velocity derivatives.
    IMPLICIT_FAST = "implicit_fast", Team: "team", "tree", "substitution", "articulated", "chains", "muscle", "dc_motor", "activation", "setpoint", "circuit", "history", "gain",
        "orientation", "actuator_derivatives", "verdict", "plastic", "clock", "due", "history_push", "outputs", "integrate", "ellipsoid", "ellipsoid_rates",
        "outer", "derivatives", "gyroscopic", "implicit_fast";
    /// The same with Coriolis forces.
    IMPLICIT = "implicit", Team: "team", "tree", "substitution", "articulated", "chains", "muscle", "dc_motor", "activation", "setpoint", "circuit", "history", "gain",
        "orientation", "actuator_derivatives", "verdict", "plastic", "clock", "due", "history_push", "outputs", "integrate", "ellipsoid", "ellipsoid_rates",
        "outer", "derivatives", "coriolis", "lu", "implicit";
    /// The same by Runge–Kutta, stage by stage.
    RUNGE_KUTTA = "runge_kutta", Team: "team", "tree", "substitution", "articulated", "dc_motor", "activation", "verdict", "plastic", "clock", "due", "history_push", "outputs", "integrate", "rk4";
}

/// What the constants before every kernel say, besides the tables.
pub(crate) struct Memory<'a> {
    pub state: &'a Fields,
    pub work: &'a Fields,
    /// What a thread of the narrow phase has for itself.
    pub thread: &'a Fields,
    /// Threads of the narrow phase for each environment.
    pub threads: usize,
    /// Rays of the sensors of each environment.
    pub rays: usize,
    pub rows: &'a Fields,
    pub reports: &'a Fields,
    pub solver: SolverMemory,
}

/// The codes of `reports`: those of [`GpuFault`](crate::GpuFault), and of what is aside and does not take part in a call.
const FAULTS: [&str; 6] = [
    "RUNNING",
    "SINGULAR",
    "DIVERGED",
    "CONTACT_OVERFLOW",
    "ASIDE",
    "UNFINISHED",
];
/// The code of an environment that does not take part in a call.
pub(crate) const ASIDE: u32 = 4;
/// What a number that diverged can be of, in the order of their codes.
pub(crate) const DIVERGED_FIELDS: [&str; 5] = ["qacc", "qfrc_constraint", "qvel", "qpos", "act"];
/// The codes of `clench_solver::Status`, in its order.
const SOLVE_STATUS: [&str; 6] = [
    "SOLVE_UNCONSTRAINED",
    "SOLVE_PROVEN",
    "SOLVE_CONVERGED",
    "SOLVE_NO_PROGRESS",
    "SOLVE_ITERATION_LIMIT",
    "SOLVE_NON_FINITE",
];

/// What stands before the texts of the kernels of a model, and what they read of it.
pub(crate) struct Preface {
    /// Declarations in WGSL.
    pub constants: String,
    pub layout: Layout,
    /// Threads of the narrow phase for each environment.
    threads: usize,
    /// Rays of its sensors.
    pub rays: usize,
}

/// What stands before the texts of the kernels of a model.
pub(crate) fn preface(tables: &Tables, memory: &Memory) -> Preface {
    let mut text = tables.constants.clone();
    let mut declare = |name: &str, value: usize| {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    };
    declare("GRID", GRID as usize);
    declare("TEAM", TEAM as usize);
    declare("NONE", NONE as usize);
    for names in [&FAULTS[..], &SOLVE_STATUS] {
        for (code, name) in names.iter().enumerate() {
            declare(name, code);
        }
    }
    for (code, name) in DIVERGED_FIELDS.iter().enumerate() {
        declare(&format!("OF_{}", name.to_uppercase()), code);
    }
    let mut layout = tables.layout.clone();
    layout.count("STATE", memory.state.size);
    layout.count("ROWS", memory.rows.size);
    layout.count("THREAD_SIZE", memory.thread.size);
    layout.count("NTHREAD", memory.threads);
    layout.count(
        "MAX_ROWS",
        memory.rows.find("r").map_or(0, |field| field.width),
    );
    layout.count("NTILE", memory.solver.ntile());
    for fields in [
        memory.state,
        memory.work,
        memory.thread,
        memory.rows,
        memory.reports,
    ] {
        for field in &fields.list {
            layout.count(&field.name.to_uppercase(), field.place);
        }
    }
    Preface {
        constants: text + &memory.solver.constants(),
        layout,
        threads: memory.threads,
        rays: memory.rays,
    }
}

impl Kernel {
    /// Its whole text, in numbers of a type.
    pub(crate) fn source<S: Texts>(&self, preface: &Preface) -> String {
        let texts = Vec::from_iter(COMMON.iter().chain(self.texts).copied()).join("\n");
        let used: HashSet<&str> = words(&texts).collect();
        let mut source = S::ELEMENTARY.to_owned();
        let _ = writeln!(source, "const GROUP: u32 = {}u;", self.workers.threads());
        for line in preface.constants.lines() {
            // Those of other kernels would tell texts apart that are the same.
            if words(line).nth(1).is_some_and(|name| used.contains(name)) {
                source += line;
                source.push('\n');
            }
        }
        source += &S::text(&preface.layout.declaration());
        source + &S::text(&preface.layout.resolve(&texts))
    }

    /// How many workgroups `count` environments take, along each axis.
    pub(crate) fn workgroups(&self, count: usize, preface: &Preface) -> [u32; 3] {
        let count = count as u32;
        let of_threads = count.div_ceil(self.workers.threads());
        match self.workers {
            Workers::Thread | Workers::Team => [of_threads, 1, 1],
            Workers::NarrowPhase => [of_threads, preface.threads as u32, 1],
            Workers::Rays => [of_threads, (preface.rays as u32).min(GRID), 1],
            Workers::Workgroup => [count.min(GRID), count.div_ceil(GRID), 1],
        }
    }
}
