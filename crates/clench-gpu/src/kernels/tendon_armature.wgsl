// The bias force of tendons with inertia, due to changes of their gradients. CPU counterpart:
// `dynamics/tendon_armature.rs`.

// Tendons share dofs, so one thread adds them all.
fn tendon_bias() {
    for (var t = 0u; is_first() && t < NTENDON; t++) {
        let armature = parameter(TENDON_ARMATURE + t);
        if (armature == 0.0) {
            continue;
        }
        let acceleration = tendon_bias_acceleration(t);
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            add(QFRC_BIAS + words[TENDON_DOF + k], fetch(TEN_JACOBIAN + k) * armature * acceleration);
        }
    }
    join();
}
