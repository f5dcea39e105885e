// Pairs of geoms that touch with friction, and their stick references. CPU counterpart: `stiction/pairs.rs`. A
// reference in the state has both geoms, each plus one, then the position and the rotation of a RelativePose.

// The pose of the second body in the frame of the first.
struct RelativePose {
    position: vec3f,
    rotation: vec4f,
}

fn pair_of(contact: u32) -> u32 {
    return u32(fetch(CONTACTS + CONTACT_SIZE * contact));
}

fn conjugate(q: vec4f) -> vec4f {
    return vec4f(q.x, -q.yzw);
}

// Returns the present pose of a pair's bodies.
fn present_pose(pair: u32) -> RelativePose {
    let first = words[PAIR_BODY + 2u * pair];
    let second = words[PAIR_BODY + 2u * pair + 1u];
    let between = fetch3(XPOS + 3u * second) - fetch3(XPOS + 3u * first);
    return RelativePose(
        transpose(fetch_matrix(XMAT + 9u * first)) * between,
        quat_product(conjugate(fetch4(XQUAT + 4u * first)), fetch4(XQUAT + 4u * second)),
    );
}

// Returns the rotation since a reference, in the frame of the first body: twice the sine of half the angle.
fn rotation_since(reference: RelativePose, present: RelativePose) -> vec3f {
    let since = quat_product(present.rotation, conjugate(reference.rotation));
    return since.yzw * select(f32(2.0), f32(-2.0), since.x < 0.0);
}
