//! Actuator forces, force = gain · input + bias, and the resulting dof forces.

use super::activation_rates::activation_rates;
use super::actuator::{ActuatorContext, ActuatorInputs};
use crate::dynamics::activation::acting_controls;
use crate::dynamics::gain::unlimited_force;
use crate::dynamics::transmission::moment;
use crate::dynamics::{dc_motor, orientation};
use crate::model::{BiasKind, Model, Params, Transmission};
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Real, kernel};

/// Computes `act_dot`, `actuator_force` and `qfrc_actuator`, with the limits of tendons, actuators and joints applied
/// in this order. Gravity compensation of joints with `actgravcomp` is part of the joint's actuation, if the model has
/// any actuator.
#[kernel]
pub fn actuation<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    offset: T,
    force: &mut Forces<T>,
) {
    force.actuator_force.fill(T::ZERO);
    force.qfrc_actuator.fill(T::ZERO);
    force.ten_actuator_force.fill(T::ZERO);
    force.act_dot.fill(T::ZERO);
    if !model.flags.actuation || model.actuators.is_empty() {
        return;
    }
    acting_controls(model, params, state, offset, &mut force.ctrl);
    let inputs = ActuatorInputs {
        ctrl: &force.ctrl,
        act: &state.act,
    };
    activation_rates(model, params, inputs, pos, vel, &mut force.act_dot);
    for (u, actuator) in model.actuators.iter().enumerate() {
        if !actuator.disabled {
            let act_dot = &force.act_dot;
            let out = &mut force.actuator_force[actuator.outputs.clone()];
            let at = ActuatorContext::new(model, params, (pos, vel), u);
            if actuator.gain.is_rotation() {
                orientation::torque(at, inputs, act_dot, (pos, vel)).write(out);
            } else {
                out[0] = unlimited_force(at, inputs, act_dot);
            }
        }
    }
    limit_tendon_forces(model, params, force);
    for (u, actuator) in model.actuators.iter().enumerate() {
        let first = actuator.outputs.start;
        if actuator.forcelimited {
            let range = params.actuator_forcerange[u];
            let out = &mut force.actuator_force[actuator.outputs.clone()];
            if actuator.gain.is_rotation() {
                orientation::limit(out, range);
            } else {
                out[0] = out[0].clamp(range[0], range[1]);
            }
        }
        // Ranges of tendons and actuators limit the force of a motor's current, without cogging and friction.
        if let Some(t) = limited_tendon(model, actuator.transmission) {
            force.ten_actuator_force[t] += force.actuator_force[first];
        }
        if actuator.bias == BiasKind::DcMotor && !actuator.disabled {
            let at = ActuatorContext::new(model, params, (pos, vel), u);
            let inputs = ActuatorInputs {
                ctrl: &force.ctrl,
                act: &state.act,
            };
            force.actuator_force[first] += dc_motor::mechanical_force(at, inputs, &force.act_dot);
        }
        for output in actuator.outputs.clone() {
            for (dof, arm) in moment(model, pos, output) {
                force.qfrc_actuator[dof] += arm * force.actuator_force[output];
            }
        }
    }
    finish_joints(model, params, force);
}

/// Returns the tendon of an actuator, if the tendon's total force is limited.
#[inline(always)]
pub(super) fn limited_tendon(model: &Model, transmission: Transmission) -> Option<usize> {
    transmission
        .tendon()
        .filter(|&t| model.tendons[t].actfrclimited)
}

/// Scales the actuators of a tendon by a common factor if their total exceeds the tendon's range.
#[inline(always)]
fn limit_tendon_forces<T: Real>(model: &Model, params: &Params<T>, force: &mut Forces<T>) {
    for actuator in &model.actuators {
        if let Some(t) = limited_tendon(model, actuator.transmission) {
            force.ten_actuator_force[t] += force.actuator_force[actuator.outputs.start];
        }
    }
    for actuator in &model.actuators {
        if let Some(t) = limited_tendon(model, actuator.transmission) {
            let total = force.ten_actuator_force[t];
            let [low, high] = params.tendon_actfrcrange[t];
            let zero = total.eq(T::ZERO);
            let share = total.clamp(low, high) / T::select(zero, T::ONE, total);
            let within = zero | (total.ge(low) & total.le(high));
            let scale = T::select(within, T::ONE, share);
            force.actuator_force[actuator.outputs.start] *= scale;
        }
    }
    force.ten_actuator_force.fill(T::ZERO);
}

#[inline(always)]
fn finish_joints<T: Real>(model: &Model, params: &Params<T>, force: &mut Forces<T>) {
    for (j, joint) in model.joints.iter().enumerate() {
        if joint.actgravcomp {
            for i in joint.dof..joint.dof + joint.kind.nv() {
                force.qfrc_actuator[i] += force.qfrc_gravcomp[i];
            }
        }
        if joint.actfrclimited {
            let [low, high] = params.jnt_actfrcrange[j];
            force.qfrc_actuator[joint.dof] = force.qfrc_actuator[joint.dof].clamp(low, high);
        }
    }
}
