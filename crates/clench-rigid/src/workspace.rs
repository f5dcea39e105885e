//! Everything derived from model and state: preallocated, reused, inspectable.

use crate::Model;
use crate::constraint::ConstraintRecord;
use crate::contact::{Collision, Contact};
use crate::dynamics::articulated::{ArticulatedInertia, articulated_bodies};
use crate::dynamics::energy::EnergyScratch;
use crate::dynamics::integrate::Integration;
use crate::profile::{Profile, StepClock};
use crate::sensor::SensorReadings;
use crate::sleep::Sleep;
use clench_math::{Force, Inertia, Mask, Mat3, Motion, Quat, Real, Vec3};
use clench_solver::{Problem, Solver};

/// Poses of everything, and what depends on positions alone.
#[derive(Clone, Debug, Default)]
pub struct Positions<T> {
    /// Body positions (nbody).
    pub xpos: Vec<Vec3<T>>,
    /// Body orientations.
    pub xquat: Vec<Quat<T>>,
    /// The same as matrices.
    pub xmat: Vec<Mat3<T>>,
    /// Centres of mass.
    pub xipos: Vec<Vec3<T>>,
    /// Orientations of inertial frames.
    pub ximat: Vec<Mat3<T>>,
    /// Rotation by each joint (njnt).
    pub jnt_turn: Vec<Quat<T>>,
    /// Joint anchors (njnt).
    pub xanchor: Vec<Vec3<T>>,
    /// Joint axes.
    pub xaxis: Vec<Vec3<T>>,
    /// Geom positions (ngeom).
    pub geom_xpos: Vec<Vec3<T>>,
    /// Geom orientations.
    pub geom_xmat: Vec<Mat3<T>>,
    /// Site positions (nsite).
    pub site_xpos: Vec<Vec3<T>>,
    /// Site orientations.
    pub site_xmat: Vec<Mat3<T>>,
    /// Centre of mass of each body and all below it (nbody). That of a body's `root` is the reference point of all
    /// spatial vectors of its tree.
    pub subtree_com: Vec<Vec3<T>>,
    /// The same times the mass (nbody).
    pub subtree_moment: Vec<Vec3<T>>,
    /// Motion of each dof at unit velocity (nv).
    pub cdof: Vec<Motion<T>>,
    /// Inertia of each body (nbody).
    pub cinert: Vec<Inertia<T>>,
    /// Inertia of each body and all below it (nbody).
    pub crb: Vec<Inertia<T>>,
    /// Tendon lengths (ntendon).
    pub ten_length: Vec<T>,
    /// ∂length/∂q of all tendons, row after row, in the pattern `Model::tendon_dofs`.
    pub ten_jacobian: Vec<T>,
    /// Actuator lengths (nactuator).
    pub actuator_length: Vec<T>,
    /// Moment arms ∂length/∂q of all actuators, row after row, in the pattern `Model::actuator_dofs`.
    pub actuator_moment: Vec<T>,
}

impl<T: Real> Positions<T> {
    /// Room for a model; what its poses are is not known yet.
    pub fn new(model: &Model) -> Self {
        let (nbody, nv, nout) = (model.nbody(), model.nv, model.nout());
        let (nj, ng, ns) = (model.joints.len(), model.geoms.len(), model.sites.len());
        let zeros = |n: usize| vec![T::ZERO; n];
        let points = |n: usize| vec![Vec3::ZERO; n];
        let frames = |n: usize| vec![Mat3::IDENTITY; n];
        Positions {
            xpos: points(nbody),
            xquat: vec![Quat::IDENTITY; nbody],
            xmat: frames(nbody),
            xipos: points(nbody),
            ximat: frames(nbody),
            jnt_turn: vec![Quat::IDENTITY; nj],
            xanchor: points(nj),
            xaxis: points(nj),
            geom_xpos: points(ng),
            geom_xmat: frames(ng),
            site_xpos: points(ns),
            site_xmat: frames(ns),
            subtree_com: points(nbody),
            subtree_moment: points(nbody),
            cdof: vec![Motion::ZERO; nv],
            cinert: vec![Inertia::ZERO; nbody],
            crb: vec![Inertia::ZERO; nbody],
            ten_length: zeros(model.tendons.len()),
            ten_jacobian: zeros(model.tendon_dofs.len()),
            actuator_length: zeros(nout),
            actuator_moment: zeros(model.actuator_dofs.len()),
        }
    }
}

/// What depends on velocities.
#[derive(Clone, Debug, Default)]
pub struct Velocities<T> {
    /// Body velocities (nbody).
    pub cvel: Vec<Motion<T>>,
    /// Rate of change of `cdof` (nv).
    pub cdof_dot: Vec<Motion<T>>,
    /// Tendon velocities (ntendon).
    pub ten_velocity: Vec<T>,
    /// Actuator velocities (nactuator).
    pub actuator_velocity: Vec<T>,
}

/// Forces along dofs (nv each) and of actuators (nactuator).
#[derive(Clone, Debug, Default)]
pub struct Forces<T> {
    /// Coriolis, centrifugal and gravity: on the left side of the equation of motion.
    pub qfrc_bias: Vec<T>,
    /// Springs.
    pub qfrc_spring: Vec<T>,
    /// Dampers.
    pub qfrc_damper: Vec<T>,
    /// Gravity compensation.
    pub qfrc_gravcomp: Vec<T>,
    /// Fluid.
    pub qfrc_fluid: Vec<T>,
    /// What contacts that adhere pull with.
    pub qfrc_adhesion: Vec<T>,
    /// All passive forces together.
    pub qfrc_passive: Vec<T>,
    /// Actuators.
    pub qfrc_actuator: Vec<T>,
    /// Everything but constraints: passive + actuator + applied − bias.
    pub qfrc_smooth: Vec<T>,
    /// Scalar force of each actuator (nactuator).
    pub actuator_force: Vec<T>,
    /// Total force of the actuators of each tendon with a limit on it, after all limits (ntendon).
    pub ten_actuator_force: Vec<T>,
    /// Controls as they act: delayed, and within their ranges (nu).
    pub ctrl: Vec<T>,
    /// Rate of change of each activation (na).
    pub act_dot: Vec<T>,
    /// Body accelerations, scratch of the bias forces (nbody).
    pub cacc: Vec<Motion<T>>,
    /// Body forces, likewise (nbody).
    pub cfrc_body: Vec<Force<T>>,
}

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
    /// How they are found.
    pub collision: Collision<T>,
    /// The convex problem: mass matrix and its factor, unconstrained acceleration, constraint blocks.
    pub problem: Problem<T>,
    /// What is known of its blocks and rows beside the problem.
    pub record: ConstraintRecord<T>,
    /// Its solver, and the solution.
    pub solver: Solver<T>,
    /// Acceleration (nv).
    pub qacc: Vec<T>,
    /// Constraint forces along dofs (nv).
    pub qfrc_constraint: Vec<T>,
    /// Whether anybody reads what a step leaves here: else a step in which everything sleeps need not know it.
    pub read: bool,
    /// Which trees are awake.
    pub sleep: Sleep<T>,
    /// What sensors measure.
    pub sensors: SensorReadings<T>,
    /// Where the mass matrix is factored by articulated bodies: scratch of that (nbody); else empty.
    pub articulated: Vec<ArticulatedInertia<T>>,
    /// Where energies of states are worked out, once one is asked for.
    pub energy: Option<Box<EnergyScratch<T>>>,
    /// What integrators need besides.
    pub integration: Integration<T>,
    /// Where the time goes, once it runs; see also the solver's.
    pub clock: StepClock,
    /// Lanes in which a matrix that had to be positive definite (the mass matrix, or that of an implicit integrator) was
    /// not: their accelerations mean nothing.
    pub singular: T::Mask,
}

impl<T: Real> Workspace<T> {
    /// Room for everything that the model needs.
    pub fn new(model: &Model) -> Self {
        let (nbody, nv, nout) = (model.nbody(), model.nv, model.nout());
        let zeros = |n: usize| vec![T::ZERO; n];
        Workspace {
            position: Positions::new(model),
            velocity: Velocities {
                cvel: vec![Motion::ZERO; nbody],
                cdof_dot: vec![Motion::ZERO; nv],
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
                cacc: vec![Motion::ZERO; nbody],
                cfrc_body: vec![Force::ZERO; nbody],
            },
            contacts: Vec::new(),
            collision: Collision::new(model),
            problem: Problem::new(model.tree.clone()),
            record: ConstraintRecord::default(),
            solver: Solver::new(&model.tree),
            qacc: zeros(nv),
            qfrc_constraint: zeros(nv),
            read: true,
            sleep: Sleep::new(model),
            sensors: SensorReadings::new(model),
            articulated: articulated_bodies(model),
            energy: None,
            integration: Integration::new(model),
            clock: StepClock::default(),
            singular: T::Mask::splat(false),
        }
    }

    /// Room for the energy of a state.
    pub fn energy_scratch(&mut self, model: &Model) -> &mut EnergyScratch<T> {
        (self.energy).get_or_insert_with(|| Box::new(EnergyScratch::new(model)))
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
