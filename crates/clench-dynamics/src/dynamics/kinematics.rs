//! Forward kinematics: from position coordinates to the poses of bodies, joints, geoms and sites.
//!
//! A body starts at its fixed pose in its parent and is then moved by its joints in turn. A rotation about an anchor p
//! leaves p where it is, so after the orientation changed from R to R′ the position is p_world − R′ p. Joint axes and
//! anchors are recorded as they are before the joint acts, which is where its motion turns them next.
//!
//! The joints' own rotations come first, in a pass of their own: they do not depend on one another, and so do not wait for
//! one another, as poses along a chain do.
//!
//! What is trivial in every environment ([`SameFrames`](crate::model::SameFrames)) is not composed but copied.
//!
//! Poses are computed for the bodies in some ranges only. The ranges leave out what is fixed to the world, and trees that sleep where they
//! slept in the last pass: their poses of that pass still hold.

use crate::model::{JointKind, Model, Params};
use crate::stages::Positions;
use crate::state::State;
use clench_math::{Mat3, Quat, Real, Vec3, kernel};
use std::ops::Range;

/// The poses that a pass computes.
#[derive(Clone, Copy, Debug)]
pub struct Computed<'a> {
    /// Ranges of the bodies whose poses they are.
    pub parts: &'a [Range<usize>],
    /// Those of geoms and sites on bodies that are fixed to the world are among them.
    pub fixed: bool,
}

impl<'a> Computed<'a> {
    /// All poses on the bodies in some ranges.
    pub fn all(parts: &'a [Range<usize>]) -> Self {
        Computed { parts, fixed: true }
    }
}

/// Poses of bodies, and of inertial frames, joints, geoms and sites on them, from `state.qpos` and the mocap poses.
///
/// Quaternions need not be of unit length: they are read normalized, and never written.
#[kernel]
pub fn kinematics<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    computed: Computed,
    pos: &mut Positions<T>,
) {
    pos.xpos[0] = Vec3::ZERO;
    pos.xquat[0] = Quat::IDENTITY;
    pos.xmat[0] = Mat3::IDENTITY;
    for part in computed.parts {
        let joints = model.joints_of(part);
        let turns = &mut pos.jnt_turn[joints.clone()];
        joint_turns(model, params, &state.qpos, joints, turns);
        for b in part.start.max(1)..part.end {
            let (xpos, xquat) = body_pose(model, params, state, pos, b);
            pos.xpos[b] = xpos;
            pos.xquat[b] = xquat;
            pos.xmat[b] = xquat.to_matrix();
        }
        attached_poses(model, params, (part, computed.fixed), pos);
    }
}

/// The rotation of each of some joints from its position at `qpos0` (a ball or free joint's whole orientation).
#[inline(always)]
fn joint_turns<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    joints: Range<usize>,
    turns: &mut [Quat<T>],
) {
    let axes = &params.jnt_axis[joints.clone()];
    for ((joint, &axis), turn) in model.joints[joints].iter().zip(axes).zip(turns) {
        let q = &qpos[joint.qpos..];
        match joint.kind {
            JointKind::Slide => {}
            JointKind::Hinge => {
                *turn = Quat::from_axis_angle(axis, q[0] - params.qpos0[joint.qpos]);
            }
            JointKind::Ball => *turn = Quat::from_slice(q).normalize(),
            JointKind::Free => *turn = Quat::from_slice(&q[3..]).normalize(),
        }
    }
}

/// The pose of body `b`; its joints' anchors and axes are written to `pos`. Factors of a product of unit quaternions
/// leave it of unit length but for rounding, so that only what the user sets is normalized.
#[inline(always)]
fn body_pose<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    pos: &mut Positions<T>,
    b: usize,
) -> (Vec3<T>, Quat<T>) {
    let body = &model.bodies[b];
    let (mut xpos, mut xquat) = match body.mocap {
        Some(m) => (state.mocap_pos[m], state.mocap_quat[m].normalize()),
        None => (params.body_pos[b], params.body_quat[b]),
    };
    let same = &model.same_frames;
    if body.parent != 0 {
        xpos = pos.xpos[body.parent] + pos.xmat[body.parent] * xpos;
        xquat = match same.bodies[b] {
            true => pos.xquat[body.parent],
            false => pos.xquat[body.parent] * xquat,
        };
    }
    for j in body.joints.clone() {
        let joint = &model.joints[j];
        if joint.kind == JointKind::Free {
            xpos = Vec3::from_slice(&state.qpos[joint.qpos..]);
            xquat = pos.jnt_turn[j];
            pos.xanchor[j] = xpos;
            pos.xaxis[j] = params.jnt_axis[j];
            continue;
        }
        let centred = same.joints[j];
        let xanchor = match centred {
            true => xpos,
            false => xpos + xquat.rotate(params.jnt_pos[j]),
        };
        let xaxis = xquat.rotate(params.jnt_axis[j]);
        if joint.kind == JointKind::Slide {
            xpos += xaxis * (state.qpos[joint.qpos] - params.qpos0[joint.qpos]);
        } else {
            xquat = xquat * pos.jnt_turn[j];
            if !centred {
                xpos = xanchor - xquat.rotate(params.jnt_pos[j]);
            }
        }
        pos.xanchor[j] = xanchor;
        pos.xaxis[j] = xaxis;
    }
    (xpos, xquat)
}

/// Inertial frames, geoms and sites, each fixed to its body; those on bodies that are `fixed` to the world only if they are wanted.
#[inline(always)]
fn attached_poses<T: Real>(
    model: &Model,
    params: &Params<T>,
    (part, fixed): (&Range<usize>, bool),
    pos: &mut Positions<T>,
) {
    let same = &model.same_frames;
    for b in part.clone() {
        if !fixed && model.is_fixed(b) {
            continue;
        }
        let body = &model.bodies[b];
        let (xpos, xquat, xmat) = (pos.xpos[b], pos.xquat[b], pos.xmat[b]);
        let body_axes = (xquat, xmat);
        if body.simple_inertia {
            (pos.xipos[b], pos.ximat[b]) = (xpos, xmat);
        } else {
            pos.xipos[b] = xpos + xmat * params.body_ipos[b];
            pos.ximat[b] = (xquat * params.body_iquat[b]).to_matrix();
        }
        for g in body.geoms.clone() {
            pos.geom_xpos[g] = xpos + xmat * params.geom_pos[g];
            pos.geom_xmat[g] = attached_axes(same.geoms[g], body_axes, params.geom_quat[g]);
        }
        for s in body.sites.clone() {
            pos.site_xpos[s] = xpos + xmat * params.site_pos[s];
            pos.site_xmat[s] = attached_axes(same.sites[s], body_axes, params.site_quat[s]);
        }
    }
}

/// The axes of a frame that stands as `quat` on a body of axes `xquat` and `xmat`, or along them.
#[inline(always)]
fn attached_axes<T: Real>(same: bool, (xquat, xmat): (Quat<T>, Mat3<T>), quat: Quat<T>) -> Mat3<T> {
    match same {
        true => xmat,
        false => (xquat * quat).to_matrix(),
    }
}
