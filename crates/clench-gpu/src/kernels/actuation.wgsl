// Actuator forces and the dof forces they make. Sister of `dynamics/actuation.rs`. A range that is not limited is one of all numbers.

// Zero where there is no actuation.
fn actuator_velocities() {
    for (var o = 0u; o < NOUT; o++) {
        var velocity: f32 = 0.0;
        for (var k = words[ACTUATOR_ROW + o]; ACTUATION && k < words[ACTUATOR_ROW + o + 1u]; k++) {
            velocity += fetch(ACTUATOR_MOMENT + k) * given(QVEL + words[ACTUATOR_DOF + k]);
        }
        put(ACTUATOR_VELOCITY + o, velocity);
    }
}

// Leaves in TEN_ACTUATOR_FORCE with how much actuators pull at each tendon whose total is limited.
fn sum_tendon_forces() {
    for (var t = 0u; t < NTENDON; t++) {
        put(TEN_ACTUATOR_FORCE + t, 0.0);
    }
    for (var u = 0u; ANY_ON_TENDON && u < NU; u++) {
        let t = words[ACTUATOR_LIMITED_TENDON + u];
        if (t != NONE) {
            add(TEN_ACTUATOR_FORCE + t, fetch(ACTUATOR_FORCE + output_of(u)));
        }
    }
}

// Where the actuators of a tendon pull with more than its range together, each is scaled by the same factor.
fn limit_tendon_forces() {
    sum_tendon_forces();
    for (var u = 0u; ANY_ON_TENDON && u < NU; u++) {
        let t = words[ACTUATOR_LIMITED_TENDON + u];
        if (t == NONE) {
            continue;
        }
        let total = fetch(TEN_ACTUATOR_FORCE + t);
        let low = parameter(TENDON_FORCE_RANGE + 2u * t);
        let high = parameter(TENDON_FORCE_RANGE + 2u * t + 1u);
        if (total != 0.0 && (total < low || total > high)) {
            let place = ACTUATOR_FORCE + output_of(u);
            put(place, fetch(place) * (clamp(total, low, high) / total));
        }
    }
}

// Holds the force of an actuator within its range.
fn limit_force(u: u32) {
    if (is_orientation_servo(u)) {
        limit_torque(u);
        return;
    }
    let place = ACTUATOR_FORCE + output_of(u);
    let range = FORCE_RANGE + 2u * u;
    put(place, clamp(fetch(place), parameter(range), parameter(range + 1u)));
}

fn actuation() {
    clear_dofs(QFRC_ACTUATOR);
    actuator_velocities();
    if (!ACTUATION) {
        return;
    }
    for (var u = 0u; u < NU; u++) {
        if (is_orientation_servo(u)) {
            put3(ACTUATOR_FORCE + output_of(u), servo_torque(u));
        } else {
            put(ACTUATOR_FORCE + output_of(u), unlimited_force(u));
        }
    }
    limit_tendon_forces();
    for (var u = 0u; u < NU; u++) {
        limit_force(u);
    }
    // A tendon's range, as an actuator's own, holds what a motor's current pulls with, without its cogging and friction.
    sum_tendon_forces();
    for (var u = 0u; u < NU; u++) {
        let output = output_of(u);
        if (ANY_CONTROLLER && words[BIAS_LAW + u] == LAW_DC_MOTOR && words[ACTUATOR_OFF + u] == 0u) {
            add(ACTUATOR_FORCE + output, mechanical_force(u, fetch(ACTUATOR_LENGTH + output)));
        }
    }
    for (var o = 0u; o < NOUT; o++) {
        let force = fetch(ACTUATOR_FORCE + o);
        for (var k = words[ACTUATOR_ROW + o]; k < words[ACTUATOR_ROW + o + 1u]; k++) {
            add(QFRC_ACTUATOR + words[ACTUATOR_DOF + k], fetch(ACTUATOR_MOMENT + k) * force);
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        if (HAS_GRAVCOMP && words[DOF_ACTGRAVCOMP + i] == 1u) {
            add(QFRC_ACTUATOR + i, fetch(QFRC_GRAVCOMP + i));
        }
        let range = DOF_FORCE_RANGE + 2u * i;
        put(QFRC_ACTUATOR + i, clamp(fetch(QFRC_ACTUATOR + i), parameter(range), parameter(range + 1u)));
    }
}
