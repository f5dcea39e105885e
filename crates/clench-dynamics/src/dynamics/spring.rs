//! Springs: the elongation of each, which determines force and energy.

use crate::dynamics::polynomial::Polynomial;
use crate::model::{JointKind, Model, Params};
use crate::state::State;
use clench_math::{Quat, Real, Vec3};

/// The displacement of a joint from its spring's rest position.
pub(crate) enum JointElongation<T> {
    /// A distance or an angle, on the joint's only dof.
    Scalar(T),
    /// A rotation vector in the child's frame.
    Rotation(Vec3<T>),
    /// A displacement in the world's frame and a rotation vector in the child's.
    Pose(Vec3<T>, Vec3<T>),
}

/// Returns the force law of joint `j`'s spring.
#[inline(always)]
pub(crate) fn joint_spring<T: Real>(params: &Params<T>, j: usize) -> Polynomial<T> {
    Polynomial::new(params.jnt_stiffness[j], params.jnt_stiffnesspoly[j])
}

/// Returns the elongation of joint `j` in a state; `None` if it has no spring in any lane.
#[inline(always)]
pub(crate) fn joint_elongation<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    j: usize,
) -> Option<JointElongation<T>> {
    let absent = joint_spring(params, j).is_zero();
    (!absent).then(|| elongation_of_joint(model, params, (&state.qpos, &state.plastic), j))
}

/// Returns the displacement of joint `j` at positions `qpos` from its spring's rest position, stored in `plastic` if it
/// yields.
#[inline(always)]
pub(crate) fn elongation_of_joint<T: Real>(
    model: &Model,
    params: &Params<T>,
    (qpos, plastic): (&[T], &[T]),
    j: usize,
) -> JointElongation<T> {
    let joint = &model.joints[j];
    let q = &qpos[joint.qpos..];
    let rest = match joint.plastic {
        Some(start) => &plastic[start..],
        None => &params.qpos_spring[joint.qpos..],
    };
    let rotation = |q: &[T], rest: &[T]| {
        Quat::from_slice(q)
            .normalize()
            .difference(Quat::from_slice(rest))
    };
    match joint.kind {
        JointKind::Slide | JointKind::Hinge => JointElongation::Scalar(q[0] - rest[0]),
        JointKind::Ball => JointElongation::Rotation(rotation(q, rest)),
        JointKind::Free => JointElongation::Pose(
            Vec3::from_slice(q) - Vec3::from_slice(rest),
            rotation(&q[3..], &rest[3..]),
        ),
    }
}

/// Returns the force law of tendon `t`'s spring.
#[inline(always)]
pub fn tendon_spring<T: Real>(params: &Params<T>, t: usize) -> Polynomial<T> {
    Polynomial::new(params.tendon_stiffness[t], params.tendon_stiffnesspoly[t])
}

/// Returns the distance of tendon `t` at `length` from its spring's dead band, stored in `plastic` if it yields.
#[inline(always)]
pub fn tendon_elongation<T: Real>(
    model: &Model,
    params: &Params<T>,
    plastic: &[T],
    t: usize,
    length: T,
) -> T {
    let band = match model.tendons[t].plastic {
        Some(start) => [plastic[start], plastic[start + 1]],
        None => params.tendon_lengthspring[t],
    };
    elongation_outside(band, length)
}

/// Returns the signed distance of a length from a dead band.
#[inline(always)]
pub(crate) fn elongation_outside<T: Real>([low, high]: [T; 2], length: T) -> T {
    let mut below = T::select(length.lt(low), length - low, T::ZERO);
    if T::IS_DUAL {
        // At a single rest length, a spring has the same derivative on both sides.
        below = T::select(low.ge(high), length - low, below);
    }
    T::select(length.gt(high), length - high, below)
}
