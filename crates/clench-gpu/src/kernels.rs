//! The kernels: their source texts, and the constants that precede them.
//!
//! A kernel is a file in `kernels/` with an entry point, and the files that it calls. WGSL has no modules: the texts
//! are concatenated after the constants of the model. Loops run over tables; nothing is unrolled for a model.

use crate::codes::{Code, codes};
use crate::fields::Fields;
use crate::layout::Layout;
use crate::precision::{Texts, words};
use crate::solver_memory::SolverMemory;
use crate::tables::{NONE, Tables};
use clench_rigid::sleep::{AWAKE, READY};
use clench_solver::Status;
use std::collections::HashSet;
use std::fmt::Write;

/// The maximum number of workgroups along x if each has one environment: a dispatch has at most 65,535 along an axis.
pub(crate) const GRID: u32 = 32_768;

/// The number of threads of a team.
pub(crate) const TEAM: u32 = 8;

/// The threads that process an environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Workers {
    /// One thread.
    Thread,
    /// A team of threads; a workgroup holds the teams of several environments.
    Team,
    /// The threads of the narrow phase; a workgroup holds those of several environments.
    NarrowPhase,
    /// A thread for each ray; a workgroup holds those of several environments. Beyond [`GRID`], threads trace several.
    Rays,
    /// The same for each vertex of a skin.
    Taxels,
    /// One workgroup.
    Workgroup,
}

impl Workers {
    /// Returns the number of threads of a workgroup: a subgroup of most GPUs if it holds several environments;
    /// otherwise four for each row of a tile of H (half as many took 10 % longer on a GPU).
    const fn threads(self) -> u32 {
        match self {
            Workers::Thread
            | Workers::Team
            | Workers::NarrowPhase
            | Workers::Rays
            | Workers::Taxels => 32,
            Workers::Workgroup => 64,
        }
    }
}

/// A kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernel {
    /// The entry point.
    pub entry: &'static str,
    /// The threads that process an environment.
    pub workers: Workers,
    /// The source texts, besides the common ones.
    texts: &'static [&'static str],
}

macro_rules! texts {
    ($($name:literal),*) => { &[$(include_str!(concat!("kernels/", $name, ".wgsl"))),*] };
}

/// The source texts that every kernel includes.
const COMMON: &[&str] = texts!["memory", "math"];

macro_rules! kernels {
    ($($(#[$doc:meta])* $constant:ident = $entry:literal, $workers:ident: $($name:literal),*;)*) => {
        $($(#[$doc])* pub(crate) const $constant: Kernel = Kernel {
            entry: $entry,
            workers: Workers::$workers,
            texts: texts![$($name),*],
        };)*
        #[cfg(test)]
        const ALL: &[Kernel] = &[$($constant),*];
    };
}

kernels! {
    /// Resets environments to the initial state.
    RESTART = "restart", Thread: "initial_state", "restart";
    /// Wakes touched trees, and lets environments rest in which everything sleeps.
    WAKE = "wake", Team: "team", "sleep/awake", "sleep/free", "sleep/touched";
    /// Computes poses, spatial inertias, the mass matrix and its factor, tendons and moment arms of actuators.
    POSITIONS = "positions", Team: "team", "kinematics", "com", "tree", "substitution", "chains", "wrap", "tendon",
        "outputs", "transmission", "articulated", "outer", "factor_m", "inertia";
    /// Finds near pairs.
    BROAD_PHASE = "broad_phase", Team: "team", "sleep/awake", "sleep/wake", "sleep/pulled", "sleep/near", "broad_phase";
    /// Finds the contacts of near pairs.
    NARROW_PHASE = "narrow_phase", NarrowPhase: "near_pairs", "shape_data", "contact_pool", "plane", "plane_mesh", "round", "cylinder", "penetration", "box_round",
        "outline", "convex/body", "convex/hull", "convex/cylinder_polyhedron", "convex/cylinders", "convex/pair", "convex/simplex", "convex/refine", "convex/gjk", "convex/polytope", "convex/epa", "convex/feature", "convex/clipping", "convex/patch", "convex/terrain/prism", "convex/terrain/grid", "convex/terrain/bounds", "convex/terrain/manifold", "convex/terrain/face_clip", "convex/terrain/terrain", "convex/convex", "box_box", "narrow_phase";
    /// Gathers contacts.
    CONTACTS = "contacts", Team: "team", "near_pairs", "slots", "sleep/awake", "sleep/wake", "sleep/touching", "contacts";
    /// Computes smooth forces and the resulting acceleration.
    FORCES = "forces", Team: "team", "tree", "substitution", "chains", "velocity", "wrap", "tendon_acceleration", "tendon_armature", "contact_adhesion", "outputs", "adhesion", "ellipsoid", "spring", "polynomial", "passive", "tendon_forces", "muscle",
        "dc_motor", "activation", "setpoint", "circuit", "history", "gain", "orientation", "actuation", "forces";
    /// Computes the metric of the integrator `discrete`, and the acceleration of smooth forces in it.
    METRIC = "metric", Team: "team", "tree", "substitution", "chains", "outputs", "muscle", "dc_motor", "activation", "setpoint", "circuit", "gain",
        "orientation", "actuator_derivatives", "length_slopes", "ellipsoid", "ellipsoid_rates", "fluid_derivatives", "spring", "polynomial", "tendon_forces", "outer",
        "along", "couplings", "backbone", "metric";
    /// Finds active constraints and their softness.
    CONSTRAINTS = "constraints", Workgroup: "group", "sleep/awake", "softness", "chains", "coordinate", "slots", "anchor_frames", "equalities", "contact_adhesion", "surface", "stiction/pairs", "stiction/displacement", "along", "constraints";
    /// Computes their Jacobians.
    ASSEMBLE = "assemble", Workgroup: "group", "chains", "coordinate", "slots", "anchor_frames", "softness", "exact", "along", "row_spring", "implicit_rows", "assembly";
    /// Solves the convex problem.
    SOLVE = "solve", Workgroup: "group", "sleep/awake", "mass", "iterate", "costs/quadratic", "costs/one_sided", "costs/huber", "costs/pyramid", "costs/slip", "costs/elliptic", "costs/coulomb", "costs/costs", "costs/hessian",
        "continuation", "normal_forces", "tiles", "factor_h", "line_search", "noslip", "noslip_metric", "along", "couplings", "backbone", "prediction", "newton", "precondition", "substitution", "cg", "descent";
    /// Spins free bodies that nothing touches, with the integrator `discrete`.
    SPIN = "spin", Team: "team", "sleep/awake", "chains", "ellipsoid", "ellipsoid_rates", "gyroscopic", "spin";
    /// Drags the stick references and the displacements of dry friction along, with the option `stiction`.
    DRAG = "drag", Workgroup: "group", "sleep/awake", "surface", "row_spring", "stiction/pairs", "stiction/friction", "stiction/return_mapping", "stiction/drag";
    /// Computes the duality gap of the solve, on request.
    GAP = "gap", Team: "team", "tree", "substitution", "articulated", "factor_m", "gap";
    /// Computes camera poses, on request.
    CAMERAS = "cameras", Thread: "cameras";
    /// Computes accelerations of bodies, forces between them and the energy, on request.
    BODY_FORCES = "body_forces", Thread: "chains", "slots", "anchor_frames", "polynomial", "tendon_forces", "wrap", "tendon_acceleration", "contact_adhesion", "wrench", "external", "spring", "energy", "body_forces";
    /// Traces the rays of sensors, on request.
    RAYS = "rays", Rays: "chord", "optics", "shape_data", "rays/primitives", "rays/triangles", "rays/terrain", "rays/rays";
    /// Reads skins, on request.
    SKINS = "skins", Taxels: "chains", "shape_data", "skins";
    /// Reads other sensors, on request.
    SENSORS = "sensors", Thread: "chains", "chord", "site_volume", "contact_adhesion", "wrench", "contact_sensor", "distance_sensor", "shape_data", "enclosed", "clock", "sample_times", "history", "sensor_delay", "optics", "sensors";
    /// Checks that the results of a forward pass outside a step are within limits.
    CHECK_FORWARD = "check_forward", Team: "team", "check_results", "check_forward";
    /// Lets slow trees fall asleep.
    FALL_ASLEEP = "fall_asleep", Team: "team", "slots", "sleep/awake", "sleep/free", "sleep/fall";
    /// Advances the state by semi-implicit Euler; also by `discrete`, whose acceleration is that of the step.
    EULER = "euler", Team: "team", "tree", "substitution", "articulated", "dc_motor", "activation", "check_results", "sleep/awake", "sleep/restore", "tendon_rate", "plastic", "stiction/advance", "clock", "sample_times", "history_push", "outputs", "polynomial", "initial_state", "autoreset", "integrate", "euler";
    /// Does the same, implicit in velocity derivatives.
    IMPLICIT_FAST = "implicit_fast", Team: "team", "tree", "substitution", "articulated", "chains", "muscle", "dc_motor", "activation", "setpoint", "circuit", "gain",
        "orientation", "actuator_derivatives", "check_results", "sleep/awake", "sleep/restore", "tendon_rate", "plastic", "stiction/advance", "clock", "sample_times", "history_push", "outputs", "polynomial", "initial_state", "autoreset", "integrate", "ellipsoid", "ellipsoid_rates",
        "outer", "fluid_derivatives", "derivatives", "gyroscopic", "implicit_fast";
    /// Does the same with Coriolis forces.
    IMPLICIT = "implicit", Team: "team", "tree", "substitution", "articulated", "chains", "muscle", "dc_motor", "activation", "setpoint", "circuit", "gain",
        "orientation", "actuator_derivatives", "check_results", "sleep/awake", "sleep/restore", "tendon_rate", "plastic", "stiction/advance", "clock", "sample_times", "history_push", "outputs", "polynomial", "initial_state", "autoreset", "integrate", "ellipsoid", "ellipsoid_rates",
        "outer", "fluid_derivatives", "derivatives", "coriolis", "lu", "implicit";
    /// Does the same by Runge–Kutta, stage by stage.
    RUNGE_KUTTA = "runge_kutta", Team: "team", "tree", "substitution", "articulated", "dc_motor", "activation", "check_results", "sleep/awake", "sleep/restore", "tendon_rate", "plastic", "stiction/advance", "clock", "sample_times", "history_push", "outputs", "polynomial", "initial_state", "autoreset", "integrate", "rk4";
}

/// The inputs of the constants before every kernel, besides the tables.
pub(crate) struct Memory<'a> {
    pub state: &'a Fields,
    pub work: &'a Fields,
    /// The private memory of a thread of the narrow phase.
    pub thread: &'a Fields,
    /// The number of threads of the narrow phase for each environment.
    pub threads: usize,
    /// The rays of the sensors of each environment.
    pub rays: usize,
    /// The vertices of their skins.
    pub taxels: usize,
    pub rows: &'a Fields,
    pub reports: &'a Fields,
    pub solver: SolverMemory,
}

codes! {
    /// The status of an environment in `reports`.
    enum Report {
        Running = "RUNNING",
        Singular = "SINGULAR",
        Diverged = "DIVERGED",
        ContactOverflow = "CONTACT_OVERFLOW",
        StickOverflow = "STICK_OVERFLOW",
        /// Excluded from a call by the host.
        Excluded = "EXCLUDED",
        Unfinished = "UNFINISHED",
        /// Runs, but the current pass would repeat the last one, in which everything slept.
        Resting = "RESTING",
    }
}
codes! {
    /// The fields that can diverge.
    enum DivergedField {
        Qacc = "OF_QACC",
        QfrcConstraint = "OF_QFRC_CONSTRAINT",
        Qvel = "OF_QVEL",
        Qpos = "OF_QPOS",
        Act = "OF_ACT",
    }
}

impl DivergedField {
    /// Returns the name of the field.
    pub(crate) fn name(self) -> &'static str {
        match self {
            DivergedField::Qacc => "qacc",
            DivergedField::QfrcConstraint => "qfrc_constraint",
            DivergedField::Qvel => "qvel",
            DivergedField::Qpos => "qpos",
            DivergedField::Act => "act",
        }
    }
}

codes! {
    of Status {
        Unconstrained = "SOLVE_UNCONSTRAINED",
        Proven = "SOLVE_PROVEN",
        Converged = "SOLVE_CONVERGED",
        NoProgress = "SOLVE_NO_PROGRESS",
        IterationLimit = "SOLVE_ITERATION_LIMIT",
        NonFinite = "SOLVE_NON_FINITE",
        TooLarge = "SOLVE_TOO_LARGE",
    }
}

/// The declarations that precede the texts of a model's kernels, and the layout that they read.
pub(crate) struct Preface {
    /// Declarations in WGSL.
    pub constants: String,
    pub layout: Layout,
    /// The threads of the narrow phase for each environment.
    threads: usize,
    /// The rays of its sensors.
    pub rays: usize,
    /// The vertices of their skins.
    pub taxels: usize,
}

/// Builds the preface of a model's kernels.
pub(crate) fn preface(tables: &Tables, memory: &Memory) -> Preface {
    let mut text = tables.constants.clone();
    let mut declare = |name: &str, value: usize| {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    };
    declare("GRID", GRID as usize);
    declare("TEAM", TEAM as usize);
    declare("NONE", NONE as usize);
    declare("MAX_ELIMINATED", clench_solver::MAX_ELIMINATED);
    Report::ALL
        .iter()
        .for_each(|x| declare(x.constant(), x.code()));
    DivergedField::ALL
        .iter()
        .for_each(|x| declare(x.constant(), x.code()));
    <Status as Code>::ALL
        .iter()
        .for_each(|x| declare(x.constant(), x.code()));
    for &(name, value) in clench_collide::CONVEX_COUNTS {
        declare(name, value);
    }
    let constants = [
        clench_solver::METHOD_CONSTANTS,
        clench_collide::SHAPE_CONSTANTS,
        clench_collide::CONVEX_CONSTANTS,
        clench_rigid::constraint::softness::SOFTNESS_CONSTANTS,
        clench_rigid::stiction::STICTION_CONSTANTS,
        &[("COUNTER_AWAKE", AWAKE), ("COUNTER_READY", READY)],
    ];
    for (name, value) in constants.concat() {
        // Without a type, so that it suits both precisions.
        let _ = writeln!(text, "const {name} = {value:?};");
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
            layout.count(&field.name.to_uppercase(), field.offset);
        }
    }
    Preface {
        constants: text + &memory.solver.constants(),
        layout,
        threads: memory.threads,
        rays: memory.rays,
        taxels: memory.taxels,
    }
}

impl Kernel {
    /// Returns true if a text of the kernel names a constant, outside comments.
    #[cfg(test)]
    fn names(&self, constant: &str) -> bool {
        let texts = COMMON.iter().chain(self.texts);
        let code = texts.flat_map(|text| text.lines().filter_map(|line| line.split("//").next()));
        code.flat_map(words).any(|word| word == constant)
    }

    /// Returns the whole source text in the given number type.
    pub(crate) fn source<S: Texts>(&self, preface: &Preface) -> String {
        let texts = Vec::from_iter(COMMON.iter().chain(self.texts).copied()).join("\n");
        let used: HashSet<&str> = words(&texts).collect();
        let mut source = S::ELEMENTARY.to_owned();
        let _ = writeln!(source, "const GROUP: u32 = {}u;", self.workers.threads());
        for line in preface.constants.lines() {
            // Constants of other kernels would make equal texts differ.
            if words(line).nth(1).is_some_and(|name| used.contains(name)) {
                source += line;
                source.push('\n');
            }
        }
        source += &S::text(&preface.layout.declaration());
        source + &S::text(&preface.layout.resolve(&texts))
    }

    /// Returns the number of workgroups for `count` environments along each axis.
    pub(crate) fn workgroups(&self, count: usize, preface: &Preface) -> [u32; 3] {
        let count = count as u32;
        let of_threads = count.div_ceil(self.workers.threads());
        match self.workers {
            Workers::Thread | Workers::Team => [of_threads, 1, 1],
            Workers::NarrowPhase => [of_threads, preface.threads as u32, 1],
            Workers::Rays => [of_threads, (preface.rays as u32).min(GRID), 1],
            Workers::Taxels => [of_threads, (preface.taxels as u32).min(GRID), 1],
            Workers::Workgroup => [count.min(GRID), count.div_ceil(GRID), 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ALL, Kernel, Memory, Preface, preface};
    use crate::fields;
    use crate::kernel_options::KernelOptions;
    use crate::precision::{Texts, words};
    use crate::solver_memory::SolverMemory;
    use crate::tables::Tables;
    use clench_rigid::options::RigidOptions;
    use clench_rigid::settings::StepSettings;
    use clench_solver::ConstraintSolver;
    use wgpu::naga;
    use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

    /// Codes that no kernel compares with.
    const UNNAMED: [&str; 3] = [
        // Only the CPU refuses large problems.
        "SOLVE_TOO_LARGE",
        // The affine law is the default case of each switch.
        "LAW_AFFINE",
        // The method for convex shapes is the last choice, taken without a comparison.
        "CONVEX",
    ];

    const SPECIALIZED: KernelOptions = KernelOptions {
        general: false,
        slots: true,
        contacts: 0,
    };

    /// Returns the preface of a model without elements.
    fn empty_preface(kernels: KernelOptions) -> Preface {
        let model = clench_formats::load_str("<mujoco/>").unwrap();
        let settings = StepSettings::new::<f64>(&model, RigidOptions::default()).unwrap();
        let (mut tables, capacity) = Tables::new::<f64>(&model, &settings, &[], kernels);
        tables.shapes(&model, &[]);
        tables.ray_shapes(&model);
        tables.solid_shapes(&model);
        tables.skins(&model);
        let state = fields::state_fields(&model, capacity);
        tables.initial_state(&model, &state);
        let memory = Memory {
            state: &state,
            work: &fields::work_fields(&model, capacity),
            thread: &fields::thread_fields(&model, capacity),
            threads: 1,
            rays: 0,
            taxels: 0,
            rows: &fields::row_fields(&model, capacity),
            reports: &fields::report_fields(&model, capacity),
            solver: SolverMemory::new::<f64>(0, ConstraintSolver::Newton, 1 << 15, kernels.general),
        };
        preface(&tables, &memory)
    }

    /// Parses and validates a kernel as a device would.
    fn check<S: Texts>(kernel: &Kernel, preface: &Preface) {
        let source = kernel.source::<S>(preface);
        let module = match naga::front::wgsl::parse_str(&source) {
            Ok(module) => module,
            Err(error) => panic!("{}", error.emit_to_string(&source)),
        };
        let (flags, capabilities) = (ValidationFlags::all(), Capabilities::FLOAT64);
        let result = Validator::new(flags, capabilities).validate(&module);
        assert!(result.is_ok(), "{}: {:?}", kernel.entry, result.err());
    }

    #[test]
    fn the_kernels_are_valid() {
        for general in [false, true] {
            let preface = empty_preface(KernelOptions {
                general,
                slots: !general,
                contacts: 0,
            });
            for kernel in ALL {
                check::<f32>(kernel, &preface);
                check::<f64>(kernel, &preface);
            }
        }
    }

    #[test]
    fn the_kernels_name_every_constant() {
        let preface = empty_preface(SPECIALIZED);
        let constants = preface
            .constants
            .lines()
            .filter(|line| !line.contains(": bool"));
        let names = constants.filter_map(|line| words(line).nth(1));
        let unnamed = names.filter(|name| !ALL.iter().any(|kernel| kernel.names(name)));
        // The host may need a size alone, and `soften` reads solimp after solref.
        let implied = |name: &str| name.ends_with("_SIZE") || name.ends_with("_SOLIMP");
        let unnamed = unnamed.filter(|name| !UNNAMED.contains(name) && !implied(name));
        assert_eq!(Vec::from_iter(unnamed), Vec::<&str>::new());
    }
}
