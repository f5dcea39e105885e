//! The time of a step by stage.

use clench_collide::ShapeKind;
use clench_solver::{SolveClock, SolvePart, Stopwatch};
use std::time::Duration;

/// A part of a step that the workspace's clock measures separately. The solver's clock measures the parts of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Poses, centres of mass, tendons, transmissions.
    Kinematics,
    /// Mass matrix.
    Inertia,
    /// Factorization of the mass matrix.
    MassFactorization,
    /// Pairs of geoms that may touch.
    BroadPhase,
    /// Contact points and their parameters.
    NarrowPhase,
    /// Velocities, passive and bias forces.
    Velocity,
    /// Actuators, the sum of all smooth forces, and their acceleration.
    Force,
    /// Assembly of the constraints into blocks of the problem.
    Assembly,
    /// The solve; a profile lists its parts instead.
    Solve,
    /// Sensors.
    Sensors,
    /// Integration of the acceleration to the next state.
    Integration,
    /// Transfer of rows to and from lanes, and checks.
    Rows,
}

impl Stage {
    /// The number of stages.
    pub const COUNT: usize = 12;
}

/// The stopwatch of the stages of steps.
pub type StepClock = Stopwatch<{ Stage::COUNT }>;

/// Time spent by stage, in the order of a step.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Name and time of each stage; the parts of the solve count as stages.
    pub stages: Vec<(&'static str, Duration)>,
    /// The time of the narrow phase by kinds of geoms.
    pub pairs: Vec<PairProfile>,
}

/// The cost of pairs of geoms of two kinds.
#[derive(Clone, Debug)]
pub struct PairProfile {
    /// The kinds.
    pub kinds: [ShapeKind; 2],
    /// The number of pairs near enough to be tested, in any of the environments of the lanes.
    pub near: u64,
    /// The number of pairs with contacts.
    pub touching: u64,
    /// The time of testing them, part of the narrow phase's time.
    pub time: Duration,
}

impl Profile {
    /// Returns the profile that the clocks of steps and of their solves measured.
    pub fn new(steps: &StepClock, solves: &SolveClock, pairs: Vec<PairProfile>) -> Self {
        let step = |name, stage| (name, steps.spent()[stage as usize]);
        let part = |name, part| (name, solves.spent()[part as usize]);
        let parts: Duration = solves.spent().iter().sum();
        let remainder = steps.spent()[Stage::Solve as usize].saturating_sub(parts);
        let stages = vec![
            step("kinematics", Stage::Kinematics),
            step("inertia", Stage::Inertia),
            step("mass factorization", Stage::MassFactorization),
            step("collision broad", Stage::BroadPhase),
            step("collision narrow", Stage::NarrowPhase),
            step("velocity", Stage::Velocity),
            step("forces", Stage::Force),
            step("assembly", Stage::Assembly),
            part("solve start", SolvePart::Start),
            part("hessian", SolvePart::Hessian),
            part("factorization", SolvePart::Factorization),
            part("direction", SolvePart::Direction),
            part("line search", SolvePart::LineSearch),
            part("evaluation", SolvePart::Evaluation),
            ("solve rest", remainder),
            step("sensors", Stage::Sensors),
            step("integration", Stage::Integration),
            step("rows and checks", Stage::Rows),
        ];
        Profile { stages, pairs }
    }

    /// Adds another's times, stage by stage and pair by pair.
    pub fn add(&mut self, other: &Profile) {
        if self.stages.is_empty() {
            self.stages.clone_from(&other.stages);
        } else {
            for (mine, theirs) in self.stages.iter_mut().zip(&other.stages) {
                mine.1 += theirs.1;
            }
        }
        for theirs in &other.pairs {
            match self
                .pairs
                .iter_mut()
                .find(|mine| mine.kinds == theirs.kinds)
            {
                Some(mine) => {
                    mine.near += theirs.near;
                    mine.touching += theirs.touching;
                    mine.time += theirs.time;
                }
                None => self.pairs.push(theirs.clone()),
            }
        }
    }

    /// Returns the sum of all stages.
    pub fn total(&self) -> Duration {
        self.stages.iter().map(|s| s.1).sum()
    }
}
