// Camera poses: one thread per environment, on request. CPU counterpart: `dynamics/camera.rs`. A camera is a row of
// CAMERA_SIZE words.

// Returns the axes of a camera that looks from one point to another, with the world's z axis upwards in its image.
fn looking(origin: vec3f, point: vec3f) -> mat3x3f {
    let z = direction(origin - point).xyz;
    let x = direction(cross(vec3f(0.0, 0.0, 1.0), z)).xyz;
    return mat3x3f(x, direction(cross(z, x)).xyz, z);
}

// Places a camera at a constant offset from a point, with a constant orientation.
fn follow(c: u32, point: vec3f, offset: u32) {
    put3(CAM_XPOS + 3u * c, point + parameter3(offset + 3u * c));
    for (var k = 9u * c; k < bound(9u * c + 9u); k++) {
        put(CAM_XMAT + k, parameter(CAM_MAT0 + k));
    }
}

// Fixes a camera to its body, and optionally turns it towards a point.
fn fix(c: u32, mode: u32, body: u32, looked_at: u32) {
    let position = fetch3(XPOS + 3u * body) + fetch_matrix(XMAT + 9u * body) * parameter3(CAM_POS + 3u * c);
    put3(CAM_XPOS + 3u * c, position);
    var axes = quat_matrix(quat_product(fetch4(XQUAT + 4u * body), parameter4(CAM_QUAT + 4u * c)));
    if (mode != FIXED) {
        axes = looking(position, fetch3(select(SUBTREE_COM, XPOS, mode == TARGET_BODY) + 3u * looked_at));
    }
    put_matrix(CAM_XMAT + 9u * c, axes);
}

@compute @workgroup_size(GROUP)
fn cameras(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    for (var c = 0u; c < bound(NCAMERA); c++) {
        let camera = CAMERAS + CAMERA_SIZE * c;
        let body = words[camera + CAMERA_BODY];
        switch words[camera + CAMERA_MODE] {
            case TRACK: {
                follow(c, fetch3(XPOS + 3u * body), CAM_POS0);
            }
            case TRACK_COM: {
                follow(c, fetch3(SUBTREE_COM + 3u * body), CAM_POSCOM0);
            }
            case FIXED, TARGET_BODY, TARGET_COM, default: {
                let mode = words[camera + CAMERA_MODE];
                fix(c, mode, body, select(words[camera + CAMERA_TARGET], 0u, mode == FIXED));
            }
        }
    }
}
