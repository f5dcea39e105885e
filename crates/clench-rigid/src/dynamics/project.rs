//! From forces on bodies to forces along dofs: Σ_b J_bᵀ f_b in one pass over the tree instead of a chain a body.

use crate::model::Model;
use crate::workspace::Positions;
use clench_math::{Force, Real, Vec3, kernel};

/// The spatial force, about the reference point of its tree, of a force and a torque that act on body `b` at `point`.
#[inline(always)]
pub fn force_at<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    b: usize,
    point: Vec3<T>,
    force: Vec3<T>,
    torque: Vec3<T>,
) -> Force<T> {
    let arm = point - pos.subtree_com[model.bodies[b].root];
    Force::new(torque + arm.cross(force), force)
}

/// Adds the dof forces of one spatial force a body to `qfrc`. `forces` is used up: afterwards each holds the force on the
/// body and all below it.
#[kernel]
pub fn project_forces<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    forces: &mut [Force<T>],
    qfrc: &mut [T],
) {
    for (b, body) in model.bodies.iter().enumerate().skip(1).rev() {
        if body.parent != 0 {
            let force = forces[b];
            forces[body.parent] += force;
        }
    }
    for ((qfrc, dof), axis) in qfrc.iter_mut().zip(&model.dofs).zip(&pos.cdof) {
        *qfrc += axis.dot(forces[dof.body]);
    }
}
