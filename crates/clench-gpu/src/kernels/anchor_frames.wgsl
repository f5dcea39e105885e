// Anchor frames of connects and welds on two bodies. CPU counterparts: `constraint/anchor_frames.rs`, `connect.rs` and
// `weld.rs`, which derive the formulas.

// Returns the origin of the first or second frame of an equality, in the world.
fn anchor_point(equality: u32, side: u32) -> vec3f {
    let b = words[EQ_PAIR + 2u * equality + side];
    let anchor = parameter3(words[EQ_PRM + equality] + select(FRAMES_ANCHOR2, FRAMES_ANCHOR1, side == 0u));
    return fetch3(XPOS + 3u * b) + fetch_matrix(XMAT + 9u * b) * anchor;
}

// Returns the orientation of a frame.
fn anchor_quat(equality: u32, side: u32) -> vec4f {
    let b = words[EQ_PAIR + 2u * equality + side];
    let quat = words[EQ_PRM + equality] + select(FRAMES_QUAT2, FRAMES_QUAT1, side == 0u);
    return quat_product(fetch4(XQUAT + 4u * b), parameter4(quat));
}

// Returns the inverse of the second frame's orientation.
fn to_second_frame(equality: u32) -> vec4f {
    let second = anchor_quat(equality, 1u);
    return vec4f(second.x, -second.yzw);
}

// Returns ρ, the orientation of the first frame in the second.
fn relative_quat(equality: u32) -> vec4f {
    return quat_product(to_second_frame(equality), anchor_quat(equality, 0u));
}

fn torquescale(equality: u32) -> f32 {
    return parameter(words[EQ_PRM + equality] + FRAMES_TORQUESCALE);
}

// Returns the imaginary part of ½ (0, u) q.
fn half_product(u: vec3f, q: vec4f) -> vec3f {
    return 0.5 * (u * q.x + cross(u, q.yzw));
}
