//! Dense Jacobians of points and subtrees, and the rates of those of points.
//!
//! Column i is the motion that dof i causes at unit velocity. With s the dof's axis as a spatial motion about o and p
//! the point, the point moves with s.linear + s.angular × (p − o), and its body rotates with s.angular. The axis turns
//! with the frame that it is fixed to, and the point moves with ṗ:
//!
//! ```text
//! d/dt (s.linear + s.angular × (p − o)) = ṡ.linear + ṡ.angular × (p − o) + s.angular × ṗ
//! ```

use crate::dynamics::chains::BodyPoint;
use crate::model::{JointKind, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Motion, Real, Vec3, kernel};

/// Returns the dofs that move a body, ascending.
#[inline(always)]
fn chain(model: &Model, body: usize) -> &[u32] {
    match model.bodies[body].last_dof {
        Some(dof) => model.tree.row(dof),
        None => &[],
    }
}

/// Writes a column of three numbers, one per row.
#[inline(always)]
fn write_column<T: Real>(rows: &mut [T], nv: usize, column: usize, value: Vec3<T>) {
    for k in 0..3 {
        rows[k * nv + column] = value[k];
    }
}

/// Writes the Jacobian of a body point (6, nv), world axes: three rows of its velocity, three of its body's angular
/// velocity.
#[kernel]
pub fn point_jacobian<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    point: &BodyPoint<T>,
    out: &mut [T],
) {
    out.fill(T::ZERO);
    let (linear, angular) = out.split_at_mut(3 * model.nv);
    for &dof in chain(model, point.body) {
        let axis = pos.cdof[dof as usize];
        write_column(
            linear,
            model.nv,
            dof as usize,
            axis.velocity_at(point.offset),
        );
        write_column(angular, model.nv, dof as usize, axis.angular);
    }
}

/// Writes the time derivative of this Jacobian (6, nv), as MuJoCo's `mj_jacDot`.
#[kernel]
pub fn point_jacobian_rate<T: Real>(
    model: &Model,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    point: &BodyPoint<T>,
    out: &mut [T],
) {
    out.fill(T::ZERO);
    let velocity = vel.cvel[point.body].velocity_at(point.offset);
    let (linear, angular) = out.split_at_mut(3 * model.nv);
    for &dof in chain(model, point.body) {
        let dof = dof as usize;
        let (axis, rate) = (pos.cdof[dof], axis_rate(model, pos, vel, dof));
        let column = rate.velocity_at(point.offset) + axis.angular.cross(velocity);
        write_column(linear, model.nv, dof, column);
        write_column(angular, model.nv, dof, rate.angular);
    }
}

/// Returns ṡ of a single dof. The rotations of a ball or free joint turn with the body. `cdof_dot` omits this turn,
/// which cancels in the sum over the joint.
#[inline(always)]
fn axis_rate<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    dof: usize,
) -> Motion<T> {
    let joint = &model.joints[model.dofs[dof].joint];
    let turns_with_body = match joint.kind {
        JointKind::Ball => true,
        JointKind::Free => dof >= joint.dof + 3,
        JointKind::Slide | JointKind::Hinge => false,
    };
    if turns_with_body {
        vel.cvel[joint.body].cross(pos.cdof[dof])
    } else {
        vel.cdof_dot[dof]
    }
}

/// Writes the Jacobian of the centre of mass of the subtree of a body (3, nv), world axes.
///
/// A dof above the body moves the subtree as one rigid body, with its centre of mass; a dof in the subtree moves only
/// the bodies below it, weighted by mass. In a massless subtree they do not count.
#[kernel]
pub fn subtree_jacobian<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    body: usize,
    out: &mut [T],
) {
    out.fill(T::ZERO);
    let mass = params.body_subtreemass[body];
    let massless = mass.le(T::ZERO);
    let inverse = T::select(
        massless,
        T::ZERO,
        T::ONE / T::select(massless, T::ONE, mass),
    );
    let point = BodyPoint::new(model, pos, body, pos.subtree_com[body]);
    for &dof in chain(model, body) {
        let column = pos.cdof[dof as usize].velocity_at(point.offset);
        write_column(out, model.nv, dof as usize, column);
    }
    for b in model.subtree(body).skip(1) {
        let share = params.body_subtreemass[b] * inverse;
        let point = BodyPoint::new(model, pos, b, pos.subtree_com[b]);
        for dof in model.bodies[b].dofs.clone() {
            let column = pos.cdof[dof].velocity_at(point.offset) * share;
            write_column(out, model.nv, dof, column);
        }
    }
}

/// Adds the dof forces of a force and a torque on a body point, world axes (MuJoCo's `mj_applyFT`).
#[kernel]
pub fn add_point_forces<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    point: &BodyPoint<T>,
    (force, torque): (Vec3<T>, Vec3<T>),
    qfrc: &mut [T],
) {
    for &dof in chain(model, point.body) {
        let axis = pos.cdof[dof as usize];
        qfrc[dof as usize] += axis.velocity_at(point.offset).dot(force) + axis.angular.dot(torque);
    }
}
