//! Everything derived from model and state: preallocated, reused, inspectable.

use crate::Model;
use crate::constraint::assembly::ConstraintRecord;
use crate::contact::Contact;
use crate::contact::collision::Collision;
use crate::dynamics::articulated::{ArticulatedInertia, articulated_bodies};
use crate::dynamics::integration::Integration;
use crate::dynamics::metric::Metric;
use crate::fixed::FixedPoses;
use crate::profile::{Profile, StepClock};
use crate::readings::SensorReadings;
use crate::sleep::Sleep;
use crate::stages::filled;
pub use crate::stages::{Forces, Positions, Velocities};
use clench_math::{Force, Mask, Motion, Real};
use clench_solver::{Problem, Solver, Threads, TreeFactor, TreeMatrix};

/// Everything derived from model and state.
#[derive(Debug)]
pub struct Workspace<T: Real> {
    /// Position stage.
    pub position: Positions<T>,
    /// Velocity stage.
    pub velocity: Velocities<T>,
    /// Force stage.
    pub force: Forces<T>,
    /// Contacts of the position stage, in canonical order.
    pub contacts: Vec<Contact<T>>,
    /// What the detection of contacts keeps and reports.
    pub collision: Collision<T>,
    /// The convex problem: mass matrix and its factor, unconstrained acceleration, constraint blocks.
    pub problem: Problem<T>,
    /// What each of its blocks and rows comes from.
    pub record: ConstraintRecord<T>,
    /// Its solver, and the solution.
    pub solver: Solver<T>,
    /// Acceleration (nv).
    pub qacc: Vec<T>,
    /// Constraint forces along dofs (nv).
    pub qfrc_constraint: Vec<T>,
    /// Whether anybody reads the workspace after a step. If nobody does, a step in which everything sleeps computes nothing.
    pub read: bool,
    /// Which trees are awake.
    pub sleep: Sleep<T>,
    /// Whether the poses of what is fixed to the world are known.
    pub fixed: FixedPoses,
    /// What sensors measure.
    pub sensors: SensorReadings<T>,
    /// Scratch of the factorization by articulated bodies (nbody); empty in a model whose mass matrix is factored otherwise.
    pub articulated: Vec<ArticulatedInertia<T>>,
    /// Scratch of the energy of a state, made when it is first asked for.
    pub energy: Option<Box<EnergyScratch<T>>>,
    /// What the integrator `discrete` adds to the mass matrix.
    pub metric: Metric<T>,
    /// Scratch of integrators.
    pub integration: Integration<T>,
    /// The threads that share the work of a step; the solver has them too.
    pub threads: Threads,
    /// Times the stages of a step while it runs. The solver and the detection of contacts have clocks of their own.
    pub clock: StepClock,
    /// Lanes in which a matrix that had to be positive definite (the mass matrix, or that of an implicit integrator) was
    /// not: their accelerations mean nothing.
    pub singular: T::Mask,
}

impl<T: Real> Workspace<T> {
    /// Room for everything that the model needs.
    pub fn new(model: &Model) -> Self {
        let (nbody, nv, nout) = (model.nbody(), model.nv, model.nout());
        let zeros = |n: usize| filled(T::ZERO, n);
        Workspace {
            position: Positions::new(model),
            velocity: Velocities {
                cvel: filled(Motion::ZERO, nbody),
                cdof_dot: filled(Motion::ZERO, nv),
                ten_velocity: zeros(model.tendons.len()),
                actuator_velocity: zeros(nout),
            },
            force: Forces {
                qfrc_bias: zeros(nv),
                qfrc_spring: zeros(nv),
                qfrc_damper: zeros(nv),
                qfrc_gravcomp: zeros(nv),
                qfrc_fluid: zeros(nv),
                qfrc_adhesion: zeros(nv),
                qfrc_passive: zeros(nv),
                qfrc_actuator: zeros(nv),
                qfrc_smooth: zeros(nv),
                actuator_force: zeros(nout),
                ten_actuator_force: zeros(model.tendons.len()),
                ctrl: zeros(model.nu()),
                act_dot: zeros(model.na),
                cacc: filled(Motion::ZERO, nbody),
                cfrc_body: filled(Force::ZERO, nbody),
            },
            contacts: Vec::new(),
            collision: Collision::new(model),
            problem: Problem::new(model.tree.clone()),
            record: ConstraintRecord::default(),
            solver: Solver::compiled(&model.tree),
            qacc: zeros(nv),
            qfrc_constraint: zeros(nv),
            read: true,
            sleep: Sleep::new(model),
            fixed: FixedPoses::new(model),
            sensors: SensorReadings::new(model),
            articulated: articulated_bodies(model),
            energy: None,
            metric: Metric::new(model),
            integration: Integration::new(model),
            threads: Threads::default(),
            clock: StepClock::default(),
            singular: T::Mask::splat(false),
        }
    }

    /// Has the next pass compute all poses, because what is here was computed from other parameters, or has to be known of a state
    /// whatever it was computed from.
    pub fn forget_poses(&mut self) {
        self.sleep.forget();
        self.fixed.forget();
    }

    /// The mass matrix, whatever metric the problem is solved in.
    pub fn mass(&self) -> &TreeMatrix<T> {
        match self.metric.acts() {
            true => &self.metric.mass,
            false => &self.problem.mass,
        }
    }

    /// The factor of the mass matrix.
    pub fn mass_factor(&self) -> &TreeFactor<T> {
        match self.metric.acts() {
            true => &self.metric.mass_factor,
            false => &self.problem.mass_factor,
        }
    }

    /// Room for the energy of a state.
    pub fn energy_scratch(&mut self, model: &Model) -> &mut EnergyScratch<T> {
        (self.energy).get_or_insert_with(|| Box::new(EnergyScratch::new(model)))
    }

    /// Has threads share the work of steps.
    pub fn set_threads(&mut self, threads: Threads) {
        self.solver.set_threads(threads.clone());
        self.threads = threads;
    }

    /// Lets the clocks of stages and of solves run, or not.
    pub fn run_clocks(&mut self, running: bool) {
        self.clock.run(running);
        self.solver.clock().run(running);
        self.collision.clock.run(running);
    }

    /// Where the time went while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        Profile::new(
            &self.clock,
            self.solver.clock(),
            self.collision.clock.profiles(),
        )
    }
}

/// Scratch of the energy of a state: the positions in the workspace are those of its last pass, which others still read.
#[derive(Clone, Debug)]
pub struct EnergyScratch<T> {
    /// Poses of the state.
    pub position: Positions<T>,
    /// The mass matrix at them.
    pub mass: TreeMatrix<T>,
}

impl<T: Real> EnergyScratch<T> {
    /// Room for a model.
    pub fn new(model: &Model) -> Self {
        EnergyScratch {
            position: Positions::new(model),
            mass: TreeMatrix::zeros(&model.tree),
        }
    }
}
