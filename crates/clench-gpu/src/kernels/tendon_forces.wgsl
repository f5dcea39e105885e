// Velocities of tendons, and the forces of their springs and dampers. Sisters of `dynamics/tendon.rs` and `passive.rs`.

fn tendon_velocities() {
    for (var t = 0u; t < NTENDON; t++) {
        var velocity: f32 = 0.0;
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            velocity += fetch(TEN_JACOBIAN + k) * given(QVEL + words[TENDON_DOF + k]);
        }
        put(TEN_VELOCITY + t, velocity);
    }
}

// How far a tendon is outside the dead band of its spring.
fn tendon_stretch(t: u32) -> f32 {
    let length = fetch(TEN_LENGTH + t);
    if (ANY_PLASTIC && words[TENDON_PLASTIC + t] != NONE) {
        let band = PLASTIC + words[TENDON_PLASTIC + t];
        return length - clamp(length, given(band), given(band + 1u));
    }
    return length - clamp(length, parameter(TENDON_SPRING + 5u * t), parameter(TENDON_SPRING + 5u * t + 1u));
}

// a + b x + c x².
fn stiffness(coefficients: vec3f, x: f32) -> f32 {
    return coefficients.x + x * (coefficients.y + x * coefficients.z);
}

// What its spring and its damper do along a tendon.
fn tendon_passive_force(t: u32) -> f32 {
    let x = tendon_stretch(t);
    let v = fetch(TEN_VELOCITY + t);
    let spring = x * stiffness(parameter3(TENDON_SPRING + 5u * t + 2u), x);
    return -spring - v * stiffness(parameter3(TENDON_DAMPER + 3u * t), abs(v));
}

fn tendon_forces() {
    for (var t = 0u; t < NTENDON; t++) {
        let force = tendon_passive_force(t);
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            add(QFRC_PASSIVE + words[TENDON_DOF + k], fetch(TEN_JACOBIAN + k) * force);
        }
    }
}
