//! Transmissions: the length of each actuator and its moment arms, ∂length/∂q along each dof.

use crate::dynamics::tendon;
use crate::model::{Joint, JointKind, Model, Params, Transmission};
use crate::workspace::Positions;
use clench_math::{Quat, Real, Vec3, kernel};

/// The dofs that a transmission acts on: where its row of `actuator_moment` may be nonzero.
#[inline(always)]
pub fn transmission_dofs(
    model: &Model,
    transmission: Transmission,
) -> impl Iterator<Item = usize> + Clone + '_ {
    let (range, joints): (_, &[usize]) = match transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            let joint = &model.joints[j];
            (joint.dof..joint.dof + joint.kind.nv(), &[])
        }
        Transmission::Tendon(t) => (0..0, &model.tendons[t].joints),
    };
    range.chain(joints.iter().map(|&j| model.joints[j].dof))
}

/// `actuator_length` and the nonzero entries of `actuator_moment`, after the kinematics.
///
/// A ball joint's length is its rotation vector along the gear, a free joint has none (zero); their gears are wrenches in
/// the child's frame, or for [`Transmission::JointInParent`] in the parent's.
#[kernel]
pub fn transmission<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    pos: &mut Positions<T>,
) {
    let nv = model.nv;
    for (u, actuator) in model.actuators.iter().enumerate() {
        let gear = &params.actuator_gear[u];
        let moment = &mut pos.actuator_moment[u * nv..(u + 1) * nv];
        pos.actuator_length[u] = match actuator.transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) => {
                let joint = &model.joints[j];
                let in_parent = matches!(actuator.transmission, Transmission::JointInParent(_));
                let arms = &mut moment[joint.dof..];
                joint_arms(
                    joint,
                    qpos[joint.qpos],
                    pos.jnt_turn[j],
                    gear,
                    in_parent,
                    arms,
                )
            }
            Transmission::Tendon(t) => {
                for (dof, coef) in tendon::terms(model, params, t) {
                    moment[dof] = coef * gear[0];
                }
                pos.ten_length[t] * gear[0]
            }
        };
    }
}

/// Writes the moment arms on a joint that stands at `q`, or at the rotation `turn`, and returns the length.
#[inline(always)]
fn joint_arms<T: Real>(
    joint: &Joint,
    q: T,
    turn: Quat<T>,
    gear: &[T; 6],
    in_parent: bool,
    arms: &mut [T],
) -> T {
    match joint.kind {
        JointKind::Slide | JointKind::Hinge => {
            arms[0] = gear[0];
            q * gear[0]
        }
        JointKind::Ball => {
            let axis = to_child(turn, in_parent, gear);
            axis.write(arms);
            turn.to_rotation_vector().dot(axis)
        }
        JointKind::Free => {
            Vec3::from_slice(gear).write(arms);
            to_child(turn, in_parent, &gear[3..]).write(&mut arms[3..]);
            T::ZERO
        }
    }
}

/// A torque on a joint that stands at the rotation `turn`, along the axes of the child.
#[inline(always)]
fn to_child<T: Real>(turn: Quat<T>, in_parent: bool, torque: &[T]) -> Vec3<T> {
    let torque = Vec3::from_slice(torque);
    if in_parent {
        turn.conjugate().rotate(torque)
    } else {
        torque
    }
}
