// Scalar functions of positions: joints, then tendons, with consecutive indices. CPU counterpart:
// `constraint/coordinate.rs`.

fn coordinate_value(c: u32) -> f32 {
    if (c < NJNT) {
        return fetch_state(QPOS + words[JNT_QPOS + c]);
    }
    return fetch(TEN_LENGTH + c - NJNT);
}

fn is_ball(c: u32) -> bool {
    return c < NJNT && words[JNT_KIND + min(c, NJNT - 1u)] == BALL;
}

// Returns the derivative of a coordinate along dof `i`.
fn coordinate_entry(c: u32, i: u32) -> f32 {
    if (c < NJNT) {
        return select(f32(0.0), f32(1.0), i == words[JNT_DOF + c]);
    }
    for (var k = words[TENDON_ROW + c - NJNT]; k < words[TENDON_ROW + c - NJNT + 1u]; k++) {
        if (words[TENDON_DOF + k] == i) {
            return fetch(TEN_JACOBIAN + k);
        }
    }
    return 0.0;
}
