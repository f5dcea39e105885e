//! Velocities of bodies, and the resulting rates of dof axes.

use crate::dynamics::tendon;
use crate::dynamics::transmission::moment;
use crate::model::{JointKind, Model};
use crate::part::Part;
use crate::stages::{Positions, Velocities};
use clench_math::{Motion, Real, kernel};

/// Computes `cvel` and `cdof_dot` of some parts, and tendon and actuator velocities.
#[kernel]
pub fn velocities<T: Real>(
    model: &Model,
    parts: &[Part],
    pos: &Positions<T>,
    qvel: &[T],
    vel: &mut Velocities<T>,
) {
    vel.cvel[0] = Motion::ZERO;
    for part in parts {
        body_velocities(model, part, pos, qvel, vel);
    }
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

/// Computes the velocity of each body from that of its parent and its own dofs. An axis fixed in the frame before its
/// joint moves with that frame's velocity. The axes of a ball joint belong to the body, but rotating them by their
/// common velocity has no effect: only Σ ċ_k v_k counts, and ω × ω = 0. A free joint's translations are along the
/// world's axes.
#[inline(always)]
fn body_velocities<T: Real>(
    model: &Model,
    part: &Part,
    pos: &Positions<T>,
    qvel: &[T],
    vel: &mut Velocities<T>,
) {
    for b in part.bodies.start.max(1)..part.bodies.end {
        let body = &model.bodies[b];
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
