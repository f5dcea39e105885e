// Anchor frames of connects and welds on two bodies. CPU counterparts: `constraint/anchor_frames.rs`, `dynamic.rs`,
// `connect.rs` and `weld.rs`, which derive the formulas.

// Returns the parameters of an equality; those of a slot lack its frames.
fn equality_parameters(equality: u32) -> u32 {
    if (is_in_slot(equality)) {
        return SLOT_PRM;
    }
    return words[EQ_PRM + equality];
}

// Returns the origin of the first or second frame, in the world.
fn anchor_point(equality: u32, side: u32) -> vec3f {
    let b = anchor_body(equality, side);
    var anchor: vec3f;
    if (is_in_slot(equality)) {
        anchor = fetch_state3(select(DYNAMIC_ANCHOR2, DYNAMIC_ANCHOR1, side == 0u) + 3u * (equality - FIRST_SLOT));
    } else {
        anchor = parameter3(words[EQ_PRM + equality] + select(FRAMES_ANCHOR2, FRAMES_ANCHOR1, side == 0u));
    }
    return fetch3(XPOS + 3u * b) + fetch_matrix(XMAT + 9u * b) * anchor;
}

// Returns the orientation of a frame. The second one of a slot has that of its body.
fn anchor_quat(equality: u32, side: u32) -> vec4f {
    let q = fetch4(XQUAT + 4u * anchor_body(equality, side));
    if (!is_in_slot(equality)) {
        return quat_product(q, parameter4(words[EQ_PRM + equality] + select(FRAMES_QUAT2, FRAMES_QUAT1, side == 0u)));
    }
    if (side == 0u) {
        return quat_product(q, fetch_state4(DYNAMIC_QUAT + 4u * (equality - FIRST_SLOT)));
    }
    return q;
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
    return parameter(equality_parameters(equality) + FRAMES_TORQUESCALE);
}

// Returns the imaginary part of ½ (0, u) q.
fn half_product(u: vec3f, q: vec4f) -> vec3f {
    return 0.5 * (u * q.x + cross(u, q.yzw));
}
