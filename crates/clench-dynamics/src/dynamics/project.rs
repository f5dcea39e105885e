//! Projection between bodies and dofs: Σ_b J_bᵀ f_b in one pass over the tree, and the frames of forces and velocities.

use crate::model::Model;
use crate::stages::Positions;
use clench_math::{Force, Mat3, Motion, Real, Vec3, kernel};

/// Returns the spatial force, about the reference point of its tree, of a force and a torque on body `b` at `point`.
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

/// Adds the dof forces of one spatial force per body to `qfrc`. Overwrites `forces` with the forces on the body and all
/// below it.
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

/// Returns a spatial velocity at the offset `arm` from its reference point, along the axes of a frame.
#[inline(always)]
pub fn local_velocity<T: Real>(motion: Motion<T>, arm: Vec3<T>, axes: &Mat3<T>) -> Motion<T> {
    Motion::new(
        axes.transpose_mul(motion.angular),
        axes.transpose_mul(motion.velocity_at(arm)),
    )
}
