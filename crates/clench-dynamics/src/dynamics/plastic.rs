//! Springs that yield.
//!
//! A spring whose stretch at the end of a step is larger than its yield rests closer from then on, by what it is stretched too far:
//! what is left is a stretch of the yield (ideal plasticity). Where springs rest is part of the state, and stays what it is within a
//! step, also between the stages of Runge and Kutta. As in MuJoCo 4.0, beside which these rules were found, joints are looked at where
//! they are after the step, and tendons where length and gradient of its start lead at the velocity that moved the positions. Neither
//! stiffness nor dead band change this; a band moves as a whole.

use crate::dynamics::spring::{JointStretch, stretch_of_joint, stretch_outside};
use crate::model::{Model, Params};
use crate::sleep::Sleep;
use crate::stages::Positions;
use clench_math::{Mask, Quat, Real, Vec3, kernel};

/// Lengths and gradients of tendons, as [`Positions`] has them.
#[derive(Clone, Copy, Debug)]
pub struct Lengths<'a, T> {
    /// Lengths (ntendon).
    pub length: &'a [T],
    /// Their gradients, entry after entry.
    pub jacobian: &'a [T],
}

impl<'a, T: Real> Lengths<'a, T> {
    /// Those at a pose.
    pub fn of(pos: &'a Positions<T>) -> Self {
        Lengths {
            length: &pos.ten_length,
            jacobian: &pos.ten_jacobian,
        }
    }
}

/// Lets springs yield after a step that has moved the positions to `qpos` along `velocity` (nv), from where tendons were as `start`
/// says. What sleeps does not yield.
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
        let Some(place) = joint.plastic else { continue };
        let awake = sleep.is_awake(model.tree.tree_of(joint.dof));
        let limit = params.jnt_springyield[j];
        let stretch = stretch_of_joint(model, params, (qpos, plastic), j);
        let rest = &mut plastic[place..place + joint.kind.nq()];
        match stretch {
            JointStretch::Scalar(x) => rest[0] += T::select(awake, beyond(x, limit), T::ZERO),
            JointStretch::Rotation(turn) => turn_rest(turn, limit, awake, rest),
            JointStretch::Pose(..) => {}
        }
    }
    for (t, tendon) in model.tendons.iter().enumerate() {
        let Some(place) = tendon.plastic else {
            continue;
        };
        let mut rate = T::ZERO;
        let mut awake = T::Mask::splat(model.tendon_dofs.dofs(t).is_empty());
        for (dof, arm) in model.tendon_dofs.row(start.jacobian, t) {
            rate += arm * velocity[dof];
            awake |= sleep.is_awake(model.tree.tree_of(dof));
        }
        let length = start.length[t] + params.timestep * rate;
        let stretch = stretch_outside([plastic[place], plastic[place + 1]], length);
        let moved = beyond(stretch, params.tendon_springyield[t]);
        for end in &mut plastic[place..place + 2] {
            *end += T::select(awake, moved, T::ZERO);
        }
    }
}

/// By how much a stretch is larger than the yield, towards its side of the rest; 0 where the spring does not yield.
#[inline(always)]
fn beyond<T: Real>(stretch: T, limit: T) -> T {
    let above = T::select(stretch.gt(limit), stretch - limit, T::ZERO);
    let out = T::select(stretch.lt(-limit), stretch + limit, above);
    T::select(limit.gt(T::ZERO), out, T::ZERO)
}

/// Turns the orientation at which a ball joint's spring rests about the axis of its stretch, until a turn by the yield is left.
#[inline(always)]
fn turn_rest<T: Real>(stretch: Vec3<T>, limit: T, awake: T::Mask, rest: &mut [T]) {
    let (axis, angle) = stretch.normalize();
    let too_far = beyond(angle, limit);
    let yields = awake & too_far.gt(T::ZERO);
    if !yields.any() {
        return;
    }
    let old = Quat::from_slice(rest);
    let turned = (old * Quat::from_axis_angle(axis, too_far)).normalize();
    Quat::select(yields, turned, old).write(rest);
}

/// Whether the spring of any tendon yields.
pub fn has_yielding_tendons(model: &Model) -> bool {
    model.tendons.iter().any(|tendon| tendon.plastic.is_some())
}
