//! Forward kinematics: from position coordinates to the poses of bodies, joints, geoms and sites.
//!
//! A body starts at its fixed pose in its parent and is then moved by its joints in turn. A rotation about an anchor p
//! leaves p fixed, so after a change of orientation from R to R′ the position is p_world − R′ p. Joint axes and anchors
//! are recorded before the joint acts; its motion rotates them next.
//!
//! The joints' own rotations are computed first in a separate pass, without the dependencies of poses along a chain.
//!
//! Transforms that are trivial in every environment ([`SameFrames`](crate::model::SameFrames)) are copied, not
//! composed.
//!
//! Poses are computed only for parts of the model. These omit bodies fixed to the world, and trees asleep since the
//! last pass, whose poses are still valid.

use crate::model::{JointKind, Model, Params};
use crate::part::Part;
use crate::stages::Positions;
use crate::state::State;
use clench_math::{Mat3, Quat, Real, Vec3, kernel};
use std::ops::Range;

/// The poses that a pass computes.
#[derive(Clone, Copy, Debug)]
pub struct Computed<'a> {
    /// The parts whose poses are computed.
    pub parts: &'a [Part],
    /// True to include geoms and sites on bodies that are fixed to the world.
    pub fixed: bool,
}

impl<'a> Computed<'a> {
    /// Selects all poses on the bodies of some parts.
    pub fn all(parts: &'a [Part]) -> Self {
        Computed { parts, fixed: true }
    }
}

/// Computes poses of bodies, and of their inertial frames, joints, geoms and sites, from `state.qpos` and the mocap
/// poses.
///
/// Quaternions need not have unit length: they are normalized when read, and never written.
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
        let rotations = &mut pos.jnt_rotation[part.joints.clone()];
        joint_rotations(model, params, &state.qpos, part.joints.clone(), rotations);
        for b in part.bodies.start.max(1)..part.bodies.end {
            let (xpos, xquat) = body_pose(model, params, state, pos, b);
            pos.xpos[b] = xpos;
            pos.xquat[b] = xquat;
            pos.xmat[b] = xquat.to_matrix();
        }
        attached_poses(model, params, (&part.bodies, computed.fixed), pos);
    }
}

/// Computes the rotation of each of some joints from `qpos0` (the whole orientation of a ball or free joint).
#[inline(always)]
fn joint_rotations<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    joints: Range<usize>,
    rotations: &mut [Quat<T>],
) {
    let axes = &params.jnt_axis[joints.clone()];
    for ((joint, &axis), rotation) in model.joints[joints].iter().zip(axes).zip(rotations) {
        let q = &qpos[joint.qpos..];
        match joint.kind {
            JointKind::Slide => {}
            JointKind::Hinge => {
                *rotation = Quat::from_axis_angle(axis, q[0] - params.qpos0[joint.qpos]);
            }
            JointKind::Ball => *rotation = Quat::from_slice(q).normalize(),
            JointKind::Free => *rotation = Quat::from_slice(&q[3..]).normalize(),
        }
    }
}

/// Returns the pose of body `b` and writes its joints' anchors and axes to `pos`. A product of unit quaternions has
/// unit length up to rounding, so only user input is normalized.
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
            xquat = pos.jnt_rotation[j];
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
            xquat = xquat * pos.jnt_rotation[j];
            if !centred {
                xpos = xanchor - xquat.rotate(params.jnt_pos[j]);
            }
        }
        pos.xanchor[j] = xanchor;
        pos.xaxis[j] = xaxis;
    }
    (xpos, xquat)
}

/// Computes inertial frames, geoms and sites on bodies; those on bodies fixed to the world only if `fixed`.
#[inline(always)]
fn attached_poses<T: Real>(
    model: &Model,
    params: &Params<T>,
    (bodies, fixed): (&Range<usize>, bool),
    pos: &mut Positions<T>,
) {
    let same = &model.same_frames;
    for b in bodies.clone() {
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

/// Returns the axes of a frame at `quat` on a body with axes `xquat`, `xmat`; the body's if `same`.
#[inline(always)]
fn attached_axes<T: Real>(same: bool, (xquat, xmat): (Quat<T>, Mat3<T>), quat: Quat<T>) -> Mat3<T> {
    match same {
        true => xmat,
        false => (xquat * quat).to_matrix(),
    }
}
