// Forward kinematics: poses of bodies, inertial frames, joints, geoms and sites. CPU counterpart:
// `dynamics/kinematics.rs`.

// Returns the rotation by a joint from its position at qpos0; the whole orientation of a ball or free joint.
fn joint_rotation(joint: u32, kind: u32, q: u32) -> vec4f {
    if (kind == HINGE) {
        let angle = fetch_state(QPOS + q) - parameter(QPOS0 + q);
        return quat_from_axis_angle(parameter3(JNT_AXIS + 3u * joint), angle);
    }
    if (kind == BALL) {
        return quat_normalize(fetch_state4(QPOS + q));
    }
    return quat_normalize(fetch_state4(QPOS + q + 3u));
}

fn body_pose(b: u32) {
    var xpos = parameter3(BODY_POS + 3u * b);
    var xquat = parameter4(BODY_QUAT + 4u * b);
    let mocap = words[BODY_MOCAP + b];
    if (mocap != NONE) {
        xpos = fetch_state3(MOCAP_POS + 3u * mocap);
        xquat = quat_normalize(fetch_state4(MOCAP_QUAT + 4u * mocap));
    }
    let parent = words[BODY_PARENT + b];
    if (parent != 0u) {
        xpos = fetch3(XPOS + 3u * parent) + fetch_matrix(XMAT + 9u * parent) * xpos;
        xquat = quat_product(fetch4(XQUAT + 4u * parent), xquat);
    }
    let last = words[BODY_JNT + b + 1u];
    for (var j = words[BODY_JNT + b]; j < last; j++) {
        let kind = words[JNT_KIND + j];
        let q = words[JNT_QPOS + j];
        let anchor = parameter3(JNT_POS + 3u * j);
        let axis = parameter3(JNT_AXIS + 3u * j);
        if (kind == FREE) {
            xpos = fetch_state3(QPOS + q);
            xquat = joint_rotation(j, kind, q);
            put3(XANCHOR + 3u * j, xpos);
            put3(XAXIS + 3u * j, axis);
            continue;
        }
        let xanchor = xpos + quat_rotate(xquat, anchor);
        let xaxis = quat_rotate(xquat, axis);
        if (kind == SLIDE) {
            xpos += xaxis * (fetch_state(QPOS + q) - parameter(QPOS0 + q));
        } else {
            xquat = quat_product(xquat, joint_rotation(j, kind, q));
            xpos = xanchor - quat_rotate(xquat, anchor);
        }
        put3(XANCHOR + 3u * j, xanchor);
        put3(XAXIS + 3u * j, xaxis);
    }
    put3(XPOS + 3u * b, xpos);
    put4(XQUAT + 4u * b, xquat);
    put_matrix(XMAT + 9u * b, quat_matrix(xquat));
}

// Computes the poses of a body's inertial frame, geoms and sites.
fn attached_poses(b: u32) {
    let xpos = fetch3(XPOS + 3u * b);
    let xquat = fetch4(XQUAT + 4u * b);
    let xmat = quat_matrix(xquat);
    put3(XIPOS + 3u * b, xpos + xmat * parameter3(BODY_IPOS + 3u * b));
    put_matrix(XIMAT + 9u * b, quat_matrix(quat_product(xquat, parameter4(BODY_IQUAT + 4u * b))));
    let last = words[BODY_GEOM + b + 1u];
    for (var g = words[BODY_GEOM + b]; g < last; g++) {
        put3(GEOM_XPOS + 3u * g, xpos + xmat * parameter3(GEOM_POS + 3u * g));
        put_matrix(GEOM_XMAT + 9u * g, quat_matrix(quat_product(xquat, parameter4(GEOM_QUAT + 4u * g))));
    }
    let last_site = words[BODY_SITE + b + 1u];
    for (var s = words[BODY_SITE + b]; s < last_site; s++) {
        put3(SITE_XPOS + 3u * s, xpos + xmat * parameter3(SITE_POS + 3u * s));
        put_matrix(SITE_XMAT + 9u * s, quat_matrix(quat_product(xquat, parameter4(SITE_QUAT + 4u * s))));
    }
}

fn kinematics() {
    if (is_first()) {
        put3(XPOS, vec3f());
        put4(XQUAT, vec4f(1.0, 0.0, 0.0, 0.0));
        put_matrix(XMAT, mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
    }
    for (var level = 1u; level < bound(NBODY_LEVEL); level++) {
        for (var n = words[BODY_LEVEL + level] + member; n < words[BODY_LEVEL + level + 1u]; n += TEAM) {
            body_pose(words[LEVEL_BODY + n]);
        }
        join();
    }
    for (var b = member; b < bound(NBODY); b += TEAM) {
        attached_poses(b);
    }
}
