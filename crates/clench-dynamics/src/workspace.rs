//! The data derived from model and state: preallocated, reused, inspectable.

use crate::Model;
use crate::contact::Contact;
use crate::contact::collision::Collision;
use crate::dynamics::articulated::{ArticulatedInertia, articulated_bodies};
use crate::dynamics::integration::Integration;
use crate::dynamics::metric::Metric;
use crate::fixed::FixedPoses;
use crate::profile::{Profile, StepClock};
use crate::readings::SensorReadings;
use crate::record::ConstraintRecord;
use crate::sleep::Sleep;
use crate::stages::filled;
pub use crate::stages::{Forces, Positions, Velocities};
use crate::stiction::Stiction;
use clench_math::{Force, Mask, Motion, Real};
use clench_solver::{Problem, Solver, Threads, TreeFactor, TreeMatrix};

/// The data derived from model and state.
#[derive(Debug)]
pub struct Workspace<T: Real> {
    /// Results of the position stage.
    pub position: Positions<T>,
    /// Results of the velocity stage.
    pub velocity: Velocities<T>,
    /// Results of the force stage.
    pub force: Forces<T>,
    /// Contacts of the position stage, in canonical order.
    pub contacts: Vec<Contact<T>>,
    /// The state and the counters of contact detection.
    pub collision: Collision<T>,
    /// The convex problem: mass matrix and its factor, unconstrained acceleration, constraint blocks.
    pub problem: Problem<T>,
    /// The origin of each block and row of the problem.
    pub record: ConstraintRecord<T>,
    /// The displacements of friction that sticks.
    pub stiction: Stiction<T>,
    /// The solver of the problem, and the solution.
    pub solver: Solver<T>,
    /// Acceleration (nv).
    pub qacc: Vec<T>,
    /// Constraint forces along dofs (nv).
    pub qfrc_constraint: Vec<T>,
    /// True if the factor of the mass matrix needs no derivatives, because only the unconstrained acceleration follows
    /// from it. Only dual numbers have any.
    pub constant_factor: bool,
    /// True if the next constraint stage reuses the blocks of the last one, which was for the same positions and
    /// velocities. Only passes in dual numbers do so.
    pub reuse_constraints: bool,
    /// True if the workspace is read after a step. Otherwise a step in which everything sleeps computes nothing.
    pub read: bool,
    /// The trees that are awake.
    pub sleep: Sleep<T>,
    /// The validity of the poses of bodies that are fixed to the world.
    pub fixed: FixedPoses,
    /// Sensor readings.
    pub sensors: SensorReadings<T>,
    /// Scratch of the articulated-body factorization (nbody); empty in a model whose mass matrix is factored otherwise.
    pub articulated: Vec<ArticulatedInertia<T>>,
    /// Scratch of the energy of a state, allocated on first use.
    pub energy: Option<Box<EnergyScratch<T>>>,
    /// The terms that the integrator `discrete` adds to the mass matrix.
    pub metric: Metric<T>,
    /// Scratch of integrators.
    pub integration: Integration<T>,
    /// The threads that share the work of a step; the solver uses them too.
    pub threads: Threads,
    /// The clock of the stages of a step. The solver and contact detection have clocks of their own.
    pub clock: StepClock,
    /// Lanes in which a matrix that must be positive definite (the mass matrix, or that of an implicit integrator) was
    /// not. Their accelerations are invalid.
    pub singular: T::Mask,
}

impl<T: Real> Workspace<T> {
    /// Allocates everything that the model needs.
    #[cold] // Compiled for size.
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
                ten_spring: zeros(model.tendons.len()),
                ten_bias: zeros(model.tendons.len()),
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
            stiction: Stiction::default(),
            solver: Solver::compiled(&model.tree),
            qacc: zeros(nv),
            qfrc_constraint: zeros(nv),
            constant_factor: false,
            reuse_constraints: false,
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

    /// Invalidates all poses, so that the next pass computes them. Needed if they were computed from other parameters
    /// or must follow from a state regardless of earlier passes.
    pub fn invalidate_poses(&mut self) {
        self.sleep.invalidate();
        self.fixed.invalidate();
    }

    /// Returns the mass matrix, whatever metric the problem is solved in.
    pub fn mass(&self) -> &TreeMatrix<T> {
        match self.metric.acts() {
            true => &self.metric.mass,
            false => &self.problem.mass,
        }
    }

    /// Returns the factor of the mass matrix.
    pub fn mass_factor(&self) -> &TreeFactor<T> {
        match self.metric.acts() {
            true => &self.metric.mass_factor,
            false => &self.problem.mass_factor,
        }
    }

    /// Returns the scratch of the energy, allocated on first use.
    pub fn energy_scratch(&mut self, model: &Model) -> &mut EnergyScratch<T> {
        (self.energy).get_or_insert_with(|| Box::new(EnergyScratch::new(model)))
    }

    /// Sets the threads that share the work of steps.
    pub fn set_threads(&mut self, threads: Threads) {
        self.solver.set_threads(threads.clone());
        self.threads = threads;
    }

    /// Starts or stops the clocks of stages and of solves.
    pub fn run_clocks(&mut self, running: bool) {
        self.clock.run(running);
        self.solver.clock().run(running);
        self.collision.clock.run(running);
    }

    /// Returns the time by stage while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        Profile::new(
            &self.clock,
            self.solver.clock(),
            self.collision.clock.profiles(),
        )
    }
}

/// Scratch of the energy of a state. The positions in the workspace are those of its last pass and are still in use.
#[derive(Clone, Debug)]
pub struct EnergyScratch<T> {
    /// Poses of the state.
    pub position: Positions<T>,
    /// The mass matrix at these poses.
    pub mass: TreeMatrix<T>,
}

impl<T: Real> EnergyScratch<T> {
    /// Allocates the scratch for a model.
    pub fn new(model: &Model) -> Self {
        EnergyScratch {
            position: Positions::new(model),
            mass: TreeMatrix::zeros(&model.tree),
        }
    }
}
