//! Forward kinematics: from position coordinates to the poses of bodies, joints, geoms and sites.
//!
//! A body starts at its fixed pose in its parent and is then moved by its joints in turn. A rotation about an anchor p
//! leaves p where it is, so after the orientation changed from R to R′ the position is p_world − R′ p. Joint axes and
//! anchors are recorded as they are before the joint acts, which is where its motion turns them next.

use crate::model::{JointKind, Model, Params};
use crate::state::State;
use crate::workspace::Positions;
use clench_math::{Mat3, Quat, Real, Vec3};

/// Poses of bodies, inertial frames, joints, geoms and sites from `state.qpos` and the mocap poses.
///
/// Quaternions need not be of unit length: they are read normalized, and never written.
pub fn kinematics<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    pos: &mut Positions<T>,
) {
    pos.xpos[0] = Vec3::ZERO;
    pos.xquat[0] = Quat::IDENTITY;
    pos.xmat[0] = Mat3::IDENTITY;
    for b in 1..model.nbody() {
        let (xpos, xquat) = body_pose(model, params, state, pos, b);
        pos.xpos[b] = xpos;
        pos.xquat[b] = xquat;
        pos.xmat[b] = xquat.to_matrix();
    }
    attached_poses(model, params, pos);
}

/// The pose of body `b`; its joints' anchors and axes are written to `pos`.
fn body_pose<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    pos: &mut Positions<T>,
    b: usize,
) -> (Vec3<T>, Quat<T>) {
    let body = &model.bodies[b];
    if let [joint] = &model.joints[body.joints.clone()]
        && joint.kind == JointKind::Free
    {
        let q = &state.qpos[joint.qpos..joint.qpos + 7];
        let j = body.joints.start;
        pos.xanchor[j] = Vec3::from_slice(q);
        pos.xaxis[j] = params.jnt_axis[j];
        return (Vec3::from_slice(q), Quat::from_slice(&q[3..]).normalize());
    }
    let (local_pos, local_quat) = match body.mocap {
        Some(m) => (state.mocap_pos[m], state.mocap_quat[m].normalize()),
        None => (params.body_pos[b], params.body_quat[b]),
    };
    let (mut xpos, mut xquat) = (local_pos, local_quat);
    if body.parent != 0 {
        xpos = pos.xpos[body.parent] + pos.xmat[body.parent] * local_pos;
        xquat = pos.xquat[body.parent] * local_quat;
    }
    for j in body.joints.clone() {
        let joint = &model.joints[j];
        let axis = params.jnt_axis[j];
        let xanchor = xpos + xquat.rotate(params.jnt_pos[j]);
        let xaxis = xquat.rotate(axis);
        let turn = match joint.kind {
            JointKind::Slide => {
                xpos += xaxis * (state.qpos[joint.qpos] - params.qpos0[joint.qpos]);
                None
            }
            JointKind::Hinge => {
                let angle = state.qpos[joint.qpos] - params.qpos0[joint.qpos];
                Some(Quat::from_axis_angle(axis, angle))
            }
            JointKind::Ball | JointKind::Free => {
                Some(Quat::from_slice(&state.qpos[joint.qpos..]).normalize())
            }
        };
        if let Some(turn) = turn {
            xquat = xquat * turn;
            xpos = xanchor - xquat.rotate(params.jnt_pos[j]);
        }
        pos.xanchor[j] = xanchor;
        pos.xaxis[j] = xaxis;
    }
    (xpos, xquat.normalize())
}

/// Inertial frames, geoms and sites, each fixed to its body.
fn attached_poses<T: Real>(model: &Model, params: &Params<T>, pos: &mut Positions<T>) {
    for b in 0..model.nbody() {
        let body = &model.bodies[b];
        let (xpos, xquat, xmat) = (pos.xpos[b], pos.xquat[b], pos.xmat[b]);
        let place = |local: Vec3<T>| xpos + xmat * local;
        let turn = |local: Quat<T>| (xquat * local).to_matrix();
        if body.simple_inertia {
            (pos.xipos[b], pos.ximat[b]) = (xpos, xmat);
        } else {
            pos.xipos[b] = place(params.body_ipos[b]);
            pos.ximat[b] = turn(params.body_iquat[b]);
        }
        for g in body.geoms.clone() {
            pos.geom_xpos[g] = place(params.geom_pos[g]);
            pos.geom_xmat[g] = turn(params.geom_quat[g]);
        }
        for s in body.sites.clone() {
            pos.site_xpos[s] = place(params.site_pos[s]);
            pos.site_xmat[s] = turn(params.site_quat[s]);
        }
    }
}
