//! Orientation servos: a torque that turns a ball joint, or a site in the frame of another, to a commanded orientation
//! along the shortest path (MuJoCo manual, XML reference, `actuator/orientation`).
//!
//! ```text
//! τ = kp log(q⁻¹ target) + c − kv ω        kp = gainprm[0],  c = biasprm[0],  −kv = biasprm[2]
//! ```
//!
//! in the frame of the rotated object. The servo has three lengths, the rotation vector of q, and three moment arms
//! with a force each. Its target is a rotation vector, of three controls or three activations that integrate them, or a
//! quaternion of four controls.

use super::activation::acting;
use super::actuator::{ActuatorContext, ActuatorInputs, scaling_error};
use crate::model::{ControlInput, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Mask, Quat, Real, Vec3, kernel};

/// The number of lengths, moment arms and forces of a servo.
pub const OUTPUTS: usize = 3;

/// Computes the torque of a servo before limits.
#[kernel]
pub fn torque<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
    (pos, vel): (&Positions<T>, &Velocities<T>),
) -> Vec3<T> {
    let outputs = at.actuator().outputs.clone();
    let now = Quat::from_rotation_vector(Vec3::from_slice(&pos.actuator_length[outputs.clone()]));
    let velocity = Vec3::from_slice(&vel.actuator_velocity[outputs]);
    let error = target(at, inputs, act_dot).difference(now);
    let [constant, _, damping, ..] = *at.biasprm();
    let constant = Vec3::new(constant, constant, constant);
    error * at.gainprm()[0] + constant + velocity * damping
}

/// Returns the target orientation of a servo.
#[inline(always)]
fn target<T: Real>(at: ActuatorContext<T>, inputs: ActuatorInputs<T>, act_dot: &[T]) -> Quat<T> {
    let actuator = at.actuator();
    let controls = &inputs.ctrl[actuator.controls.clone()];
    if actuator.inputs[0] == ControlInput::Quaternion {
        return Quat::from_slice(controls).normalize();
    }
    if actuator.acts.is_empty() {
        return Quat::from_rotation_vector(Vec3::from_slice(controls));
    }
    let mut vector = [T::ZERO; OUTPUTS];
    for (a, part) in actuator.acts.clone().zip(&mut vector) {
        *part = acting(at, inputs, act_dot, a);
    }
    Quat::from_rotation_vector(Vec3::from_array(vector))
}

/// Clamps the norm of a torque and retains its direction.
#[inline(always)]
pub fn limit<T: Real>(torque: &mut [T], range: [T; 2]) {
    let norm = Vec3::from_slice(torque).norm();
    let over = norm.gt(range[1]);
    let share = T::select(over, range[1] / T::select(over, norm, T::ONE), T::ONE);
    torque.iter_mut().for_each(|part| *part *= share);
}

/// Returns ∂torque/∂ω, equal about each axis; zero if the limit clamps the torque.
#[inline(always)]
pub fn slope<T: Real>(model: &Model, params: &Params<T>, u: usize, forces: &[T]) -> T {
    let slope = params.actuator_biasprm[u][2];
    T::select(is_at_limit(model, params, u, forces), T::ZERO, slope)
}

/// Returns ∂torque/∂angle at small angles from the target, likewise.
#[kernel]
pub fn length_slope<T: Real>(model: &Model, params: &Params<T>, u: usize, forces: &[T]) -> T {
    let slope = -params.actuator_gainprm[u][0];
    T::select(is_at_limit(model, params, u, forces), T::ZERO, slope)
}

/// Returns the lanes in which the limit clamps the torque.
#[inline(always)]
fn is_at_limit<T: Real>(model: &Model, params: &Params<T>, u: usize, forces: &[T]) -> T::Mask {
    let actuator = &model.actuators[u];
    if !actuator.forcelimited {
        return T::Mask::splat(false);
    }
    let norm = Vec3::from_slice(&forces[actuator.outputs.clone()]).norm();
    // In MuJoCo, rounding decides if a torque scaled to its limit is at the limit.
    norm.ge(params.actuator_forcerange[u][1] * (T::ONE - scaling_error()))
}

/// Subtracts whole turns from a rotation vector of more than half a turn, at the same orientation.
#[inline(always)]
pub fn shorten<T: Real>(vector: &mut [T]) {
    let angle = Vec3::from_slice(vector).norm();
    let over = angle.gt(T::new(std::f64::consts::PI));
    if !over.any() {
        return;
    }
    let full_turn = T::new(std::f64::consts::TAU);
    let angle = T::select(over, angle, T::ONE);
    let rest = angle - full_turn * (angle / full_turn + T::new(0.5)).floor();
    let share = T::select(over, rest / angle, T::ONE);
    vector.iter_mut().for_each(|part| *part *= share);
}
