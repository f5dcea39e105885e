//! Transmissions: the length of each actuator and its moment arms, ∂length/∂q along each dof.

use crate::dynamics::site_transmission::{
    relative_pose, relative_rotation, slider_crank, turning_arms, wrench_arms,
};
use crate::model::{Joint, JointKind, Model, Params, Transmission};
use crate::stages::Positions;
use clench_math::{Quat, Real, Vec3, kernel};

/// Returns the dofs of an actuator force, one of `Model::nout`, with its moment arm along each.
#[inline(always)]
pub fn moment<'a, T: Real>(
    model: &'a Model,
    pos: &'a Positions<T>,
    output: usize,
) -> impl Iterator<Item = (usize, T)> + Clone + 'a {
    model.actuator_dofs.row(&pos.actuator_moment, output)
}

/// Computes `actuator_length` and `actuator_moment`, after the kinematics and the tendons.
///
/// A ball joint's length is its rotation vector along the gear, that of a free joint is zero; their gears are wrenches
/// in the child's frame, or for [`Transmission::JointInParent`] in the parent's. Transmissions to contacts have no
/// length.
#[kernel]
pub fn transmissions<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    pos: &mut Positions<T>,
) {
    let mut moments = std::mem::take(&mut pos.actuator_moment);
    for (u, actuator) in model.actuators.iter().enumerate() {
        let gear = &params.actuator_gear[u];
        let first = actuator.outputs.start;
        let row = &mut moments[model.actuator_dofs.range(first)];
        pos.actuator_length[first] = match actuator.transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) => {
                let joint = &model.joints[j];
                let in_parent = matches!(actuator.transmission, Transmission::JointInParent(_));
                let (q, rotation) = (qpos[joint.qpos], pos.jnt_rotation[j]);
                joint_arms(joint, q, rotation, gear, in_parent, row)
            }
            Transmission::Tendon(t) => {
                let gradient = &pos.ten_jacobian[model.tendon_dofs.range(t)];
                for (arm, &derivative) in row.iter_mut().zip(gradient) {
                    *arm = derivative * gear[0];
                }
                pos.ten_length[t] * gear[0]
            }
            Transmission::Site(site) => {
                wrench_arms(model, pos, site, gear, row);
                T::ZERO
            }
            Transmission::SiteInFrame(sites) => relative_pose(model, params, pos, sites, gear, row),
            Transmission::SliderCrank(sites) => slider_crank(model, params, pos, u, sites, row),
            // Its moment arms are computed after the contacts, see `adhesion`.
            Transmission::Body(_) => T::ZERO,
            // Three lengths, those of a rotation vector, and arms about the axes of the rotated object.
            Transmission::Rotation(j) => {
                let vector = pos.jnt_rotation[j].to_rotation_vector();
                vector.write(&mut pos.actuator_length[actuator.outputs.clone()]);
                for output in actuator.outputs.clone() {
                    moments[model.actuator_dofs.range(output)].fill(T::ONE);
                }
                continue;
            }
            Transmission::RotationInFrame(sites) => {
                let vector = relative_rotation(model, params, pos, sites);
                vector.write(&mut pos.actuator_length[actuator.outputs.clone()]);
                for (axis, output) in actuator.outputs.clone().enumerate() {
                    let row = &mut moments[model.actuator_dofs.range(output)];
                    turning_arms(model, pos, sites, axis, row);
                }
                continue;
            }
        };
    }
    pos.actuator_moment = moments;
}

/// Writes the moment arms on a joint at position `q` or rotation `rotation`, and returns the length.
#[inline(always)]
fn joint_arms<T: Real>(
    joint: &Joint,
    q: T,
    rotation: Quat<T>,
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
            let axis = to_child(rotation, in_parent, gear);
            axis.write(arms);
            rotation.to_rotation_vector().dot(axis)
        }
        JointKind::Free => {
            Vec3::from_slice(gear).write(arms);
            to_child(rotation, in_parent, &gear[3..]).write(&mut arms[3..]);
            T::ZERO
        }
    }
}

/// Returns a torque on a joint at the rotation `rotation`, along the axes of the child.
#[inline(always)]
fn to_child<T: Real>(rotation: Quat<T>, in_parent: bool, torque: &[T]) -> Vec3<T> {
    let torque = Vec3::from_slice(torque);
    if in_parent {
        rotation.conjugate().rotate(torque)
    } else {
        torque
    }
}
