// Displacements of joints from their springs' rest positions. CPU counterpart: `dynamics/spring.rs`.

// Returns the rest value of the number `q` of a joint's position.
fn rest(j: u32, q: u32) -> f32 {
    if (ANY_PLASTIC && words[JNT_PLASTIC + j] != NONE) {
        return fetch_state(PLASTIC + words[JNT_PLASTIC + j] + q - words[JNT_QPOS + j]);
    }
    return parameter(QPOS_SPRING + q);
}

fn rest3(j: u32, q: u32) -> vec3f {
    return vec3f(rest(j, q), rest(j, q + 1u), rest(j, q + 2u));
}

// Returns that of a slide or hinge.
fn joint_displacement(j: u32, q: u32) -> f32 {
    return fetch_state(QPOS + q) - rest(j, q);
}

// Returns that of a free joint's position.
fn joint_shift(j: u32, q: u32) -> vec3f {
    return fetch_state3(QPOS + q) - rest3(j, q);
}

// Returns that of an orientation, as a rotation vector.
fn joint_rotation(j: u32, q: u32) -> vec3f {
    return quat_difference(quat_normalize(fetch_state4(QPOS + q)), vec4f(rest3(j, q), rest(j, q + 3u)));
}
