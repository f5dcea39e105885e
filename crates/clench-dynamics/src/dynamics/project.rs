//! Projection between bodies and dofs: Σ_b J_bᵀ f_b in one pass over the tree, and the frames of forces and velocities.

use crate::model::Model;
use crate::part::Part;
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

/// Adds the dof forces of one spatial force per body of some parts to `qfrc`. Overwrites `forces` with the forces on
/// the body and all below it.
#[kernel]
pub fn project_forces<T: Real>(
    model: &Model,
    parts: &[Part],
    pos: &Positions<T>,
    forces: &mut [Force<T>],
    qfrc: &mut [T],
) {
    for part in parts {
        for b in part.bodies.clone().rev() {
            let parent = model.bodies[b].parent;
            if parent != 0 {
                let force = forces[b];
                forces[parent] += force;
            }
        }
        let dofs = part.dofs.clone();
        let axes = model.dofs[dofs.clone()].iter().zip(&pos.cdof[dofs.clone()]);
        for (qfrc, (dof, axis)) in qfrc[dofs].iter_mut().zip(axes) {
            *qfrc += axis.dot(forces[dof.body]);
        }
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
