// Advancing the state. Sister of `dynamics/integrate.rs` and `euler.rs`.

// Moves qpos along the velocity at `velocity` (in work) for `time` seconds.
fn integrate_positions(velocity: u32, time: f32) {
    for (var j = 0u; j < bound(NJNT); j++) {
        let kind = words[JNT_KIND + j];
        var q = QPOS + words[JNT_QPOS + j];
        var v = velocity + words[JNT_DOF + j];
        if (kind == SLIDE || kind == HINGE) {
            keep(q, given(q) + fetch(v) * time);
            continue;
        }
        if (kind == FREE) {
            for (var k = 0u; k < 3u; k++) {
                keep(q + k, given(q + k) + fetch(v + k) * time);
            }
            q += 3u;
            v += 3u;
        }
        let turned = quat_integrate(quat_normalize(given4(q)), fetch3(v), time);
        for (var k = 0u; k < 4u; k++) {
            keep(q + k, turned[k]);
        }
    }
}

// Remembers the state at the start of a step.
fn save_start() {
    for (var i = 0u; i < bound(NQ); i++) {
        put(START_QPOS + i, given(QPOS + i));
    }
    for (var i = 0u; i < bound(NV); i++) {
        put(START_QVEL + i, given(QVEL + i));
        put(START_WARMSTART + i, given(QACC_WARMSTART + i));
    }
    for (var a = 0u; a < NA; a++) {
        put(START_ACT + a, given(ACT + a));
    }
}

fn restore_start() {
    for (var i = 0u; i < bound(NQ); i++) {
        keep(QPOS + i, fetch(START_QPOS + i));
    }
    for (var i = 0u; i < bound(NV); i++) {
        keep(QVEL + i, fetch(START_QVEL + i));
    }
    for (var a = 0u; a < NA; a++) {
        keep(ACT + a, fetch(START_ACT + a));
    }
}

// Takes whole turns off a rotation vector of more than half a turn, which stands for the same orientation then.
fn shorten(place: u32) {
    let vector = given3(place);
    let angle = length(vector);
    if (angle > PI) {
        let share = (angle - TWO_PI * floor(angle / TWO_PI + 0.5)) / angle;
        for (var k = 0u; k < 3u; k++) {
            keep(place + k, vector[k] * share);
        }
    }
}

// Moves activations a time step on, at the rates in `rates` (in work), for velocities of actuators in `velocities`. Those of actuators
// that are off stay where they are, but for whole turns on a circle.
fn advance_activations(rates: u32, velocities: u32) {
    for (var a = 0u; ACTUATION && a < NA; a++) {
        let u = words[ACT_ACTUATOR + a];
        let rate = select(fetch(rates + a), 0.0, words[ACTUATOR_OFF + u] == 1u);
        var next = next_activation(u, a, given(ACT + a), rate, fetch(velocities + output_of(u)));
        if (words[ACTUATOR_SERVO + u] == 1u) {
            next = nearest_setpoint(u, next, fetch(ACTUATOR_LENGTH + output_of(u)));
        }
        keep(ACT + a, next);
    }
    for (var u = 0u; ANY_ORIENTATION && ACTUATION && u < NU; u++) {
        if (is_orientation_servo(u) && words[ACTUATOR_ACT + u] != NONE) {
            shorten(ACT + words[ACTUATOR_ACT + u] - 2u);
        }
    }
}

// Lets the step count, or takes it back where it led nowhere. For springs that yield: the velocity that moved the positions, and lengths
// and gradients of tendons at the start (all in work).
fn finish_step(velocity: u32, length: u32, jacobian: u32) {
    note_end();
    judge_results();
    for (var i = 0u; i < bound(NV); i++) {
        keep(QACC_WARMSTART + i, fetch(QACC + i));
    }
    let fault = reports[TROUBLE * envs + env];
    if (fault == RUNNING) {
        if (ANY_PLASTIC) {
            yield_springs(velocity, length, jacobian);
        }
        if (ANY_DELAY) {
            push_controls();
        }
        if (ANY_SENSOR_HISTORY) {
            push_measurements();
        }
        reports[STEPS * envs + env] += 1u;
        return;
    }
    reports[STATUS * envs + env] = fault;
    restore_start();
    for (var i = 0u; i < bound(NV); i++) {
        keep(QACC_WARMSTART + i, fetch(START_WARMSTART + i));
    }
}

// Minus the change of a damper's force with its velocity.
fn damping_slope(law: u32, velocity: f32) -> f32 {
    let v = abs(velocity);
    return parameter(law) + v * (2.0 * parameter(law + 1u) + v * 3.0 * parameter(law + 2u));
}

// What damping adds to the diagonal of M.
fn added_inertia(i: u32) -> f32 {
    return TIMESTEP * damping_slope(DOF_DAMPER + 3u * i, given(QVEL + i));
}

// Factors M + h B into QLD; false where a pivot is not positive.
fn factor_damped() -> bool {
    if (LONG_PATHS) {
        return articulated_factor();
    }
    for (var p = 0u; p < bound(NNZ); p++) {
        put(QLD + p, fetch(QM + p));
    }
    for (var i = 0u; i < bound(NV); i++) {
        add(QLD + words[TREE_START + i + 1u] - 1u, added_inertia(i));
    }
    return factor_tree();
}

// The acceleration that advances the velocity: damping is implicit, so it solves (M + h B) a = τ + Jᵀf.
fn damped_acceleration() {
    if (!IMPLICIT_DAMPING) {
        for (var i = 0u; i < bound(NV); i++) {
            put(RATE + i, fetch(QACC + i));
        }
        return;
    }
    for (var i = 0u; i < bound(NV); i++) {
        put(RATE + i, fetch(QFRC_SMOOTH + i) + fetch(QFRC_CONSTRAINT + i));
    }
    if (!factor_damped()) {
        trouble(SINGULAR);
    }
    solve_tree(RATE);
}

// Activations, then velocities by the acceleration in RATE, then positions with the new velocities.
fn advance_semi_implicit() {
    advance_activations(ACT_DOT, ACTUATOR_VELOCITY);
    for (var i = 0u; i < bound(NV); i++) {
        let v = given(QVEL + i) + fetch(RATE + i) * TIMESTEP;
        keep(QVEL + i, v);
        put(RATE + i, v);
    }
    integrate_positions(RATE, TIMESTEP);
    finish_step(RATE, TEN_LENGTH, TEN_JACOBIAN);
}
