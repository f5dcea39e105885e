//! Mechanical energy, J.

use crate::dynamics::spring::{
    JointElongation, joint_elongation, joint_spring, tendon_elongation, tendon_spring,
};
use crate::model::{Model, Params};
use crate::stages::Positions;
use crate::state::State;
use clench_math::{Real, kernel};
use clench_solver::TreeMatrix;

/// The energy of a state, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy<T> {
    /// The energy of gravity (zero at the height of the world's origin) and of springs.
    pub potential: T,
    /// ½ q̇ᵀ M q̇, including armature.
    pub kinetic: T,
}

/// Computes the energy of a state from its positions `pos` and mass matrix.
#[kernel]
pub fn energy<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    mass: &TreeMatrix<T>,
    state: &State<T>,
) -> Energy<T> {
    let mut potential = T::ZERO;
    if model.flags.gravity {
        for (&mass, &xipos) in params.body_mass.iter().zip(&pos.xipos).skip(1) {
            potential -= mass * params.gravity.dot(xipos);
        }
    }
    if model.flags.spring {
        potential += spring_energy(model, params, pos, state);
    }
    Energy {
        potential,
        kinetic: kinetic_energy(model, mass, &state.qvel),
    }
}

/// Computes the energy of all springs.
#[inline(always)]
fn spring_energy<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    state: &State<T>,
) -> T {
    let mut energy = T::ZERO;
    for j in 0..model.joints.len() {
        let spring = joint_spring(params, j);
        energy += match joint_elongation(model, params, state, j) {
            None => T::ZERO,
            Some(JointElongation::Scalar(x)) => spring.energy(x),
            Some(JointElongation::Rotation(rotation)) => spring.energy(rotation.norm()),
            Some(JointElongation::Pose(shift, rotation)) => {
                spring.energy(shift.norm()) + spring.energy(rotation.norm())
            }
        };
    }
    for (t, &length) in pos.ten_length.iter().enumerate() {
        let elongation = tendon_elongation(model, params, &state.plastic, t, length);
        energy += tendon_spring(params, t).energy(elongation);
    }
    energy
}

/// Computes ½ vᵀ M v, each pair of the lower triangle once.
#[inline(always)]
fn kinetic_energy<T: Real>(model: &Model, mass: &TreeMatrix<T>, qvel: &[T]) -> T {
    let half = T::new(0.5);
    let mut energy = T::ZERO;
    for (i, &v) in qvel.iter().enumerate() {
        let mut momentum = T::ZERO;
        for (&j, &entry) in model.tree.row(i).iter().zip(mass.row(&model.tree, i)) {
            let share = if j as usize == i { half } else { T::ONE };
            momentum += share * entry * qvel[j as usize];
        }
        energy += momentum * v;
    }
    energy
}
