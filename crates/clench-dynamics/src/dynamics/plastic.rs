//! Springs that yield.
//!
//! If the elongation of a spring at the end of a step exceeds its yield, its rest position moves by the excess, so that
//! the yield remains as elongation (ideal plasticity). Rest positions are part of the state and constant within a step,
//! including Runge–Kutta stages. As in MuJoCo 4.0, with which these rules were determined, joints are evaluated at
//! their positions after the step, and tendons by extrapolating their initial length and gradient with the velocity
//! that moved the positions. Stiffness and width of the dead band do not change.

use crate::dynamics::spring::{JointElongation, elongation_of_joint, elongation_outside};
use crate::model::{Model, Params};
use crate::sleep::Sleep;
use crate::stages::Lengths;
use clench_math::{Mask, Quat, Real, Vec3, kernel};

/// Updates yielding springs after a step that moved the positions to `qpos` along `velocity` (nv), with the tendons
/// initially at `start`. Sleeping springs do not yield.
#[kernel]
pub(crate) fn yield_springs<T: Real>(
    model: &Model,
    params: &Params<T>,
    sleep: &Sleep<T>,
    start: Lengths<T>,
    (qpos, velocity): (&[T], &[T]),
    plastic: &mut [T],
) {
    if plastic.is_empty() || !model.flags.spring {
        return;
    }
    for (j, joint) in model.joints.iter().enumerate() {
        let Some(offset) = joint.plastic else {
            continue;
        };
        let awake = sleep.is_awake(model.tree.tree_of(joint.dof));
        let limit = params.jnt_springyield[j];
        let elongation = elongation_of_joint(model, params, (qpos, plastic), j);
        let rest = &mut plastic[offset..offset + joint.kind.nq()];
        match elongation {
            JointElongation::Scalar(x) => rest[0] += T::select(awake, beyond(x, limit), T::ZERO),
            JointElongation::Rotation(rotation) => yield_rotation(rotation, limit, awake, rest),
            JointElongation::Pose(..) => {}
        }
    }
    for (t, tendon) in model.tendons.iter().enumerate() {
        let Some(offset) = tendon.plastic else {
            continue;
        };
        let mut rate = T::ZERO;
        let mut awake = T::Mask::splat(model.tendon_dofs.dofs(t).is_empty());
        for (dof, arm) in model.tendon_dofs.row(start.jacobian, t) {
            rate += arm * velocity[dof];
            awake |= sleep.is_awake(model.tree.tree_of(dof));
        }
        let length = start.length[t] + params.timestep * rate;
        let elongation = elongation_outside([plastic[offset], plastic[offset + 1]], length);
        let moved = beyond(elongation, params.tendon_springyield[t]);
        for end in &mut plastic[offset..offset + 2] {
            *end += T::select(awake, moved, T::ZERO);
        }
    }
}

/// Returns the signed excess of an elongation over the yield; 0 if the spring does not yield.
#[inline(always)]
fn beyond<T: Real>(elongation: T, limit: T) -> T {
    let above = T::select(elongation.gt(limit), elongation - limit, T::ZERO);
    let out = T::select(elongation.lt(-limit), elongation + limit, above);
    T::select(limit.gt(T::ZERO), out, T::ZERO)
}

/// Turns the rest orientation of a ball joint's spring about the axis of its elongation, until the yield remains
/// as elongation.
#[inline(always)]
fn yield_rotation<T: Real>(elongation: Vec3<T>, limit: T, awake: T::Mask, rest: &mut [T]) {
    let (axis, angle) = elongation.normalize();
    let too_far = beyond(angle, limit);
    let yields = awake & too_far.gt(T::ZERO);
    if !yields.any() {
        return;
    }
    let old = Quat::from_slice(rest);
    let rotated = (old * Quat::from_axis_angle(axis, too_far)).normalize();
    Quat::select(yields, rotated, old).write(rest);
}

/// Returns true if the spring of any tendon yields.
pub fn has_yielding_tendons(model: &Model) -> bool {
    model.tendons.iter().any(|tendon| tendon.plastic.is_some())
}
