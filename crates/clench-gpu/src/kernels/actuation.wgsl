// Actuator forces and the resulting dof forces. CPU counterpart: `dynamics/actuation.rs`. Ranges that are not limited
// contain all numbers.

// Stores the controls of actuator `u` after their delay, clamped to their ranges.
fn store_controls(u: u32) {
    for (var c = words[ACTUATOR_CTRL + u]; c < words[ACTUATOR_CTRL + u + 1u]; c++) {
        var ctrl = fetch_state(CTRL + c);
        if (ANY_DELAY && words[ACTUATOR_HISTORY + u] != NONE) {
            let delay = parameter(ACTUATOR_DELAY + u);
            if (delay > 0.0) {
                ctrl = read_history(words[ACTUATOR_HISTORY + u], fetch(OFFSET) - delay, c - words[ACTUATOR_CTRL + u]);
            }
        }
        put(ACTING_CTRL + c, clamp(ctrl, parameter(CTRL_RANGE + 2u * c), parameter(CTRL_RANGE + 2u * c + 1u)));
    }
}

// Computes an output's velocity; zero without actuation.
fn actuator_velocity(o: u32) {
    var velocity: f32 = 0.0;
    for (var k = words[ACTUATOR_ROW + o]; ACTUATION && k < words[ACTUATOR_ROW + o + 1u]; k++) {
        velocity += fetch(ACTUATOR_MOMENT + k) * fetch_state(QVEL + words[ACTUATOR_DOF + k]);
    }
    put(ACTUATOR_VELOCITY + o, velocity);
}

// Stores in TEN_ACTUATOR_FORCE the total actuator force on each tendon with a force limit.
fn sum_tendon_forces() {
    for (var t = 0u; is_first() && t < NTENDON; t++) {
        put(TEN_ACTUATOR_FORCE + t, 0.0);
    }
    for (var u = 0u; is_first() && ANY_ON_TENDON && u < NU; u++) {
        let t = words[ACTUATOR_LIMITED_TENDON + u];
        if (t != NONE) {
            add(TEN_ACTUATOR_FORCE + t, fetch(ACTUATOR_FORCE + output_of(u)));
        }
    }
    join();
}

// Scales the actuator forces of a tendon by a common factor if their total exceeds the tendon's range.
fn limit_tendon_forces() {
    sum_tendon_forces();
    for (var u = member; ANY_ON_TENDON && u < NU; u += TEAM) {
        let t = words[ACTUATOR_LIMITED_TENDON + u];
        if (t == NONE) {
            continue;
        }
        let total = fetch(TEN_ACTUATOR_FORCE + t);
        let low = parameter(TENDON_FORCE_RANGE + 2u * t);
        let high = parameter(TENDON_FORCE_RANGE + 2u * t + 1u);
        if (total != 0.0 && (total < low || total > high)) {
            let offset = ACTUATOR_FORCE + output_of(u);
            put(offset, fetch(offset) * (clamp(total, low, high) / total));
        }
    }
}

// Clamps the force of an actuator to its range.
fn limit_force(u: u32) {
    if (is_orientation_servo(u)) {
        limit_torque(u);
        return;
    }
    let offset = ACTUATOR_FORCE + output_of(u);
    let range = FORCE_RANGE + 2u * u;
    put(offset, clamp(fetch(offset), parameter(range), parameter(range + 1u)));
}

// Sums the forces of all outputs with a moment arm on a dof.
fn actuator_force_on(i: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var n = words[DOF_ARM + i]; n < words[DOF_ARM + i + 1u]; n++) {
        sum += fetch(ACTUATOR_MOMENT + words[ARM_ENTRY + n]) * fetch(ACTUATOR_FORCE + words[ARM_OUTPUT + n]);
    }
    if (HAS_GRAVCOMP && words[DOF_ACTGRAVCOMP + i] == 1u) {
        sum += fetch(QFRC_GRAVCOMP + i);
    }
    let range = DOF_FORCE_RANGE + 2u * i;
    return clamp(sum, parameter(range), parameter(range + 1u));
}

fn actuation() {
    for (var u = member; u < NU; u += TEAM) {
        for (var o = output_of(u); o < output_of(u + 1u); o++) {
            actuator_velocity(o);
        }
        if (ACTUATION) {
            store_controls(u);
        }
        if (ACTUATION && is_orientation_servo(u)) {
            put3(ACTUATOR_FORCE + output_of(u), servo_torque(u));
        } else if (ACTUATION) {
            put(ACTUATOR_FORCE + output_of(u), unlimited_force(u));
        }
    }
    if (!ACTUATION) {
        clear_dofs(QFRC_ACTUATOR);
        return;
    }
    if (ANY_ON_TENDON) {
        join();
        limit_tendon_forces();
    }
    for (var u = member; u < NU; u += TEAM) {
        limit_force(u);
    }
    // The ranges of actuators and tendons limit the force of a motor's current, without its cogging and friction.
    if (NTENDON > 0u) {
        join();
        sum_tendon_forces();
    }
    for (var u = member; u < NU; u += TEAM) {
        let output = output_of(u);
        if (ANY_CONTROLLER && words[BIAS_LAW + u] == LAW_DC_MOTOR && words[ACTUATOR_OFF + u] == 0u) {
            let force = fetch(ACTUATOR_FORCE + output);
            put(CURRENT_FORCE + output, force);
            put(ACTUATOR_FORCE + output, force + mechanical_force(u, fetch(ACTUATOR_LENGTH + output)));
        }
    }
    join();
    for (var i = member; i < bound(NV); i += TEAM) {
        put(QFRC_ACTUATOR + i, actuator_force_on(i));
    }
}
