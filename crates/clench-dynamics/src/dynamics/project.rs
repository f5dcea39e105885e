//! Between bodies and dofs: Σ_b J_bᵀ f_b in one pass over the tree instead of a chain a body, and the frames that forces are told in.

use crate::model::Model;
use crate::stages::Positions;
use clench_math::{Force, Mat3, Motion, Real, Vec3, kernel};

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

/// A spatial velocity at the point that is `arm` from where it is measured, along the axes of a frame.
#[inline(always)]
pub fn local_velocity<T: Real>(motion: Motion<T>, arm: Vec3<T>, axes: &Mat3<T>) -> Motion<T> {
    Motion::new(
        axes.transpose_mul(motion.angular),
        axes.transpose_mul(motion.velocity_at(arm)),
    )
}
