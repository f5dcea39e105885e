// The forces of tendon springs and dampers. CPU counterpart: `dynamics/passive.rs`.

// Returns the elongation of a tendon beyond the dead band of its spring.
fn tendon_stretch(t: u32) -> f32 {
    let length = fetch(TEN_LENGTH + t);
    if (ANY_PLASTIC && words[TENDON_PLASTIC + t] != NONE) {
        let band = PLASTIC + words[TENDON_PLASTIC + t];
        return length - clamp(length, fetch_state(band), fetch_state(band + 1u));
    }
    return length - clamp(length, parameter(TENDON_SPRING + 5u * t), parameter(TENDON_SPRING + 5u * t + 1u));
}

// Returns the force of the spring and damper along a tendon.
fn tendon_passive_force(t: u32) -> f32 {
    let x = tendon_stretch(t);
    let v = fetch(TEN_VELOCITY + t);
    let spring = x * stiffness(parameter3(TENDON_SPRING + 5u * t + 2u), x);
    return -spring - v * stiffness(parameter3(TENDON_DAMPER + 3u * t), abs(v));
}
