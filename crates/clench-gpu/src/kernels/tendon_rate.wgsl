// The rate of a tendon's length. CPU counterparts: `dynamics/plastic.rs` and `stiction/friction.rs`.

// Returns the rate along the velocity at `velocity`, with the gradients at `jacobian` (both in work).
fn tendon_rate(t: u32, velocity: u32, jacobian: u32) -> f32 {
    var rate: f32 = 0.0;
    for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
        rate += fetch(jacobian + k) * fetch(velocity + words[TENDON_DOF + k]);
    }
    return rate;
}
