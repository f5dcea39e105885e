//! The forces of joints and actuators without those of bodies: functions of the coordinates of each joint or actuator
//! alone, for derivatives by them.

use super::actuation::actuation;
use super::actuator_derivatives::velocity_derivative;
use super::fluid::fluid_acts;
use super::integrate::advance_activations;
use super::passive::passive_forces;
use super::reflected::dof_damper;
use super::spring::joint_spring;
use crate::model::{JointKind, Model, Params};
use crate::part::Part;
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Mask, Real};

/// Returns true if passive forces are those of joints, and actuators act on joints with one coordinate each: all smooth
/// forces except inertial ones then follow from these coordinates. Forces of contacts and applied ones do not count.
pub fn is_local<T: Real>(model: &Model, params: &Params<T>) -> bool {
    let zero = |x: &T| x.eq(T::ZERO).all();
    let of_one_dof = |joint: usize| match model.joints[joint].kind {
        JointKind::Hinge | JointKind::Slide => true,
        JointKind::Ball | JointKind::Free => false,
    };
    model.tendons.is_empty()
        && !fluid_acts(model, params)
        && params.body_gravcomp.iter().all(zero)
        && model
            .actuators
            .iter()
            .all(|actuator| actuator.transmission.joint().is_some_and(of_one_dof))
}

/// Returns true if a joint has a spring or a damper.
pub fn is_sprung<T: Real>(model: &Model, params: &Params<T>, joint: usize) -> bool {
    let start = model.joints[joint].dof;
    let mut dofs = start..start + model.joints[joint].kind.nv();
    !joint_spring(params, joint).is_zero() || dofs.any(|i| !dof_damper(model, params, i).is_zero())
}

/// The coordinates of joints and actuators besides those of the state, and the forces that follow from them.
#[derive(Clone, Debug)]
pub struct LocalStages<T> {
    /// Lengths and moment arms of actuators; nothing else is set.
    pub position: Positions<T>,
    /// Velocities of actuators; nothing else is set.
    pub velocity: Velocities<T>,
    /// Passive forces, and those of actuators.
    pub force: Forces<T>,
}

impl<T: Real> LocalStages<T> {
    /// Allocates memory for a [local](is_local) model.
    pub fn new(model: &Model) -> Self {
        let zeros = |n: usize| vec![T::ZERO; n];
        let (nv, nout) = (model.nv, model.nout());
        LocalStages {
            position: Positions {
                actuator_length: zeros(nout),
                actuator_moment: zeros(model.actuator_dofs.len()),
                ..Positions::default()
            },
            velocity: Velocities {
                actuator_velocity: zeros(nout),
                ..Velocities::default()
            },
            force: Forces {
                qfrc_spring: zeros(nv),
                qfrc_damper: zeros(nv),
                qfrc_gravcomp: zeros(nv),
                qfrc_fluid: zeros(nv),
                qfrc_adhesion: zeros(nv),
                qfrc_passive: zeros(nv),
                qfrc_actuator: zeros(nv),
                actuator_force: zeros(nout),
                ctrl: zeros(model.nu()),
                act_dot: zeros(model.na),
                ..Forces::default()
            },
        }
    }

    /// Computes the forces of a model that is [local](is_local).
    pub fn run(&mut self, model: &Model, params: &Params<T>, state: &State<T>) {
        let (pos, vel, force) = (&self.position, &self.velocity, &mut self.force);
        let whole = [Part::whole(model)];
        passive_forces(model, params, &whole, (pos, vel), state, &[], force);
        actuation(model, params, state, pos, vel, T::ZERO, force);
    }

    /// Advances activations, after [`run`](Self::run).
    pub fn advance(&self, model: &Model, params: &Params<T>, act: &mut [T]) {
        let stages = (&self.position, &self.velocity);
        advance_activations(model, params, stages, &self.force.act_dot, act);
    }

    /// Returns the derivative of the force of actuator `u` by its velocity, after [`run`](Self::run).
    pub fn velocity_slope(
        &self,
        model: &Model,
        params: &Params<T>,
        state: &State<T>,
        u: usize,
    ) -> T {
        let stages = (&self.position, &self.velocity, &self.force);
        velocity_derivative(model, params, state, stages, u)
    }
}

/// Returns minus the derivative of the damping force of dof `i` by its velocity `v`.
pub fn dof_damping_slope<T: Real>(model: &Model, params: &Params<T>, i: usize, v: T) -> T {
    dof_damper(model, params, i).damping_slope(v)
}
