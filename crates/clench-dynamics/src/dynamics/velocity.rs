//! Velocities of bodies, and how the dof axes turn with them.

use crate::dynamics::tendon;
use crate::dynamics::transmission::moment;
use crate::model::{JointKind, Model};
use crate::stages::{Positions, Velocities};
use clench_math::{Motion, Real, kernel};

/// `cvel`, `cdof_dot`, tendon and actuator velocities.
#[kernel]
pub fn velocities<T: Real>(model: &Model, pos: &Positions<T>, qvel: &[T], vel: &mut Velocities<T>) {
    body_velocities(model, pos, qvel, vel);
    tendon::tendon_velocities(model, pos, qvel, &mut vel.ten_velocity);
    for (u, velocity) in vel.actuator_velocity.iter_mut().enumerate() {
        *velocity = T::ZERO;
        if model.flags.actuation {
            for (dof, arm) in moment(model, pos, u) {
                *velocity += arm * qvel[dof];
            }
        }
    }
}

/// A body moves as its parent does, plus its own dofs. An axis fixed in the frame before its joint moves with that
/// frame's velocity. The axes of a ball joint are the body's own, but turning about one of them by their common velocity
/// is of no account: what counts is Σ ċ_k v_k, and ω × ω = 0. A free joint's translations keep the world's axes.
#[inline(always)]
fn body_velocities<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    qvel: &[T],
    vel: &mut Velocities<T>,
) {
    vel.cvel[0] = Motion::ZERO;
    for (b, body) in model.bodies.iter().enumerate().skip(1) {
        let mut cvel = vel.cvel[body.parent];
        for joint in &model.joints[body.joints.clone()] {
            let mut dofs = joint.dof..joint.dof + joint.kind.nv();
            if joint.kind == JointKind::Free {
                for i in dofs.by_ref().take(3) {
                    vel.cdof_dot[i] = Motion::ZERO;
                    cvel += pos.cdof[i] * qvel[i];
                }
            }
            let before = cvel;
            for i in dofs {
                vel.cdof_dot[i] = before.cross(pos.cdof[i]);
                cvel += pos.cdof[i] * qvel[i];
            }
        }
        vel.cvel[b] = cvel;
    }
}
