//! The forces of joints, tendons and actuators without those of bodies: functions of the coordinates of each joint,
//! tendon or actuator alone, for derivatives by them.

use super::actuation::actuation;
use super::actuator_derivatives::velocity_derivative;
use super::fluid::fluid_acts;
use super::integrate::advance_activations;
use super::passive::passive_forces;
use super::reflected::{dof_damper, tendon_damper};
use super::spring::{joint_spring, tendon_elongation, tendon_spring};
use crate::model::{Actuator, Model, Params, Transmission};
use crate::part::Part;
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::Real;

/// Returns true if all smooth forces follow from the coordinates of each joint, tendon and actuator alone, except those
/// of inertia, of gravity compensation, of contacts and applied ones.
pub fn is_local<T: Real>(model: &Model, params: &Params<T>) -> bool {
    let alone = |actuator: &Actuator| match actuator.transmission {
        // The range of a tendon scales the forces of all its actuators.
        Transmission::Tendon(t) => !model.tendons[t].actfrclimited,
        Transmission::Joint(_)
        | Transmission::JointInParent(_)
        | Transmission::Site(_)
        | Transmission::SiteInFrame(_)
        | Transmission::SliderCrank(_) => true,
        Transmission::Body(_) | Transmission::Rotation(_) | Transmission::RotationInFrame(_) => {
            false
        }
    };
    !fluid_acts(model, params) && model.actuators.iter().all(alone)
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
    /// Lengths of tendons and actuators, and their gradients; nothing else is set.
    pub position: Positions<T>,
    /// Velocities of tendons and actuators; nothing else is set.
    pub velocity: Velocities<T>,
    /// Passive forces, and those of actuators.
    pub force: Forces<T>,
}

impl<T: Real> LocalStages<T> {
    /// Allocates memory for a [local](is_local) model.
    pub fn new(model: &Model) -> Self {
        let zeros = |n: usize| vec![T::ZERO; n];
        let (nv, nout, ntendon) = (model.nv, model.nout(), model.tendons.len());
        LocalStages {
            position: Positions {
                ten_length: zeros(ntendon),
                ten_jacobian: zeros(model.tendon_dofs.len()),
                actuator_length: zeros(nout),
                actuator_moment: zeros(model.actuator_dofs.len()),
                ..Positions::default()
            },
            velocity: Velocities {
                ten_velocity: zeros(ntendon),
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
                ten_spring: zeros(ntendon),
                ten_actuator_force: zeros(ntendon),
                ctrl: zeros(model.nu()),
                act_dot: zeros(model.na),
                ..Forces::default()
            },
        }
    }

    /// Computes the forces of a model that is [local](is_local), without gravity compensation in the parameters.
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

/// Returns the tension of the spring and damper of tendon `t`, as a force along its length.
pub fn tendon_tension<T: Real>(
    model: &Model,
    params: &Params<T>,
    plastic: &[T],
    t: usize,
    (length, velocity): (T, T),
) -> T {
    let mut tension = T::ZERO;
    if model.flags.spring {
        let elongation = tendon_elongation(model, params, plastic, t, length);
        tension += -elongation * tendon_spring(params, t).stiffness(elongation);
    }
    if model.flags.damper {
        tension += -velocity * tendon_damper(model, params, t).damping(velocity);
    }
    tension
}

/// Returns minus the derivative of the damping force of tendon `t` by its velocity `v`.
pub fn tendon_damping_slope<T: Real>(model: &Model, params: &Params<T>, t: usize, v: T) -> T {
    tendon_damper(model, params, t).damping_slope(v)
}
