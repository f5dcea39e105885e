//! Inertia of tendons: the kinetic energy ½ m (J v)² of a tendon whose length changes with J v.
//!
//! It adds m JᵀJ to the mass matrix, and m Jᵀ (J̇ v) to the bias forces. As in MuJoCo, couplings of dofs of different
//! branches are omitted, which preserves the pattern of the mass matrix.

use crate::dynamics::derivatives::add_outer;
use crate::dynamics::reflected::tendon_armature;
use crate::dynamics::tendon::{add_tendon_force, gradient};
use crate::dynamics::tendon_path::bias_acceleration;
use crate::model::{Model, Params};
use crate::stages::{Forces, Positions, Velocities};
use clench_math::{Mask, Real, kernel};
use clench_solver::TreeMatrix;

/// Adds the inertia of all tendons to the mass matrix.
#[kernel]
pub fn add_tendon_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    mass: &mut TreeMatrix<T>,
) {
    for t in 0..model.tendons.len() {
        let armature = tendon_armature(model, params, t);
        add_outer(model, gradient(model, pos, t), armature, mass);
    }
}

/// Adds the inertial forces of tendons at zero dof acceleration, due to changing gradients, to `qfrc_bias`.
#[kernel]
pub fn add_tendon_bias<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    qvel: &[T],
    force: &mut Forces<T>,
) {
    for t in 0..model.tendons.len() {
        let armature = tendon_armature(model, params, t);
        if !model.tendons[t].is_spatial() || armature.eq(T::ZERO).all() {
            continue;
        }
        let acceleration = bias_acceleration(model, params, pos, vel, qvel, t);
        force.ten_bias[t] = acceleration;
        add_tendon_force(model, pos, t, armature * acceleration, &mut force.qfrc_bias);
    }
}
