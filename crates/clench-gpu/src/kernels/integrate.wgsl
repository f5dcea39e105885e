// Advancing the state. CPU counterparts: `dynamics/integrate.rs` and `euler.rs`.

// Moves qpos along the velocity at `velocity` (in work) for `time` seconds.
fn integrate_positions(velocity: u32, time: f32) {
    for (var j = member; j < bound(NJNT); j += TEAM) {
        let kind = words[JNT_KIND + j];
        var q = QPOS + words[JNT_QPOS + j];
        var v = velocity + words[JNT_DOF + j];
        if (kind == SLIDE || kind == HINGE) {
            put_state(q, fetch_state(q) + fetch(v) * time);
            continue;
        }
        if (kind == FREE) {
            for (var k = 0u; k < 3u; k++) {
                put_state(q + k, fetch_state(q + k) + fetch(v + k) * time);
            }
            q += 3u;
            v += 3u;
        }
        let turned = quat_integrate(quat_normalize(fetch_state4(q)), fetch3(v), time);
        for (var k = 0u; k < 4u; k++) {
            put_state(q + k, turned[k]);
        }
    }
}

// Saves the state at the start of a step.
fn save_start() {
    for (var i = member; i < bound(NQ); i += TEAM) {
        put(START_QPOS + i, fetch_state(QPOS + i));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        put(START_QVEL + i, fetch_state(QVEL + i));
        put(START_WARMSTART + i, fetch_state(QACC_WARMSTART + i));
    }
    for (var a = member; a < NA; a += TEAM) {
        put(START_ACT + a, fetch_state(ACT + a));
    }
}

fn restore_start() {
    for (var i = member; i < bound(NQ); i += TEAM) {
        put_state(QPOS + i, fetch(START_QPOS + i));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        put_state(QVEL + i, fetch(START_QVEL + i));
    }
    for (var a = member; a < NA; a += TEAM) {
        put_state(ACT + a, fetch(START_ACT + a));
    }
}

// Reduces a rotation vector of more than half a turn by full turns to the same orientation.
fn shorten(offset: u32) {
    let vector = fetch_state3(offset);
    let angle = length(vector);
    if (angle > PI) {
        let share = (angle - TWO_PI * floor(angle / TWO_PI + 0.5)) / angle;
        for (var k = 0u; k < 3u; k++) {
            put_state(offset + k, vector[k] * share);
        }
    }
}

// Advances activations by a time step, with the rates in `rates` and the actuator velocities in `velocities` (in work).
// Those of disabled actuators are constant up to full turns on a circle.
fn advance_activations(rates: u32, velocities: u32) {
    for (var a = member; ACTUATION && a < NA; a += TEAM) {
        let u = words[ACT_ACTUATOR + a];
        let rate = select(fetch(rates + a), 0.0, words[ACTUATOR_OFF + u] == 1u);
        var next = next_activation(u, a, fetch_state(ACT + a), rate, fetch(velocities + output_of(u)));
        if (words[ACTUATOR_SERVO + u] == 1u) {
            next = nearest_setpoint(u, next, fetch(ACTUATOR_LENGTH + output_of(u)));
        }
        put_state(ACT + a, next);
    }
    if (!ANY_ORIENTATION || !ACTUATION) {
        return;
    }
    join();
    for (var u = member; u < NU; u += TEAM) {
        if (is_orientation_servo(u) && words[ACTUATOR_ACT + u] != NONE) {
            shorten(ACT + words[ACTUATOR_ACT + u] - 2u);
        }
    }
}

// Completes the step, or reverts it after a fault. Springs that yield and friction that sticks need the velocity that
// moved the positions, and lengths and gradients of tendons at the start (all in work).
fn finish_step(velocity: u32, length: u32, jacobian: u32) {
    end_in_team();
    check_results();
    let fault = reports[FAILURE * envs + env];
    if (fault == RUNNING) {
        for (var i = member; i < bound(NV); i += TEAM) {
            put_state(QACC_WARMSTART + i, fetch(QACC + i));
        }
        if (SLEEP) {
            restore_sleeping();
        }
        if (ANY_PLASTIC) {
            yield_springs(velocity, length, jacobian);
        }
        if (STICTION) {
            advance_friction(velocity, jacobian);
        }
        if (ANY_DELAY) {
            push_controls();
        }
        if (ANY_SENSOR_HISTORY) {
            push_measurements();
        }
    } else if (is_repeated(fault)) {
        start_over();
    } else {
        restore_start();
        for (var i = member; i < bound(NV); i += TEAM) {
            put_state(QACC_WARMSTART + i, fetch(START_WARMSTART + i));
        }
        if (STICTION) {
            restore_memory();
        }
    }
    // The time advances after its last use.
    join();
    if (is_first() && fault == RUNNING) {
        reports[STEPS * envs + env] += 1u;
        if (AUTORESET) {
            reports[REPEATS * envs + env] = 0u;
        }
    } else if (is_first()) {
        count_failure(fault);
    }
}

// Returns the damping term of M's diagonal.
fn added_inertia(i: u32) -> f32 {
    return TIMESTEP * damping_slope(DOF_DAMPER + 3u * i, fetch_state(QVEL + i));
}

// Factors M + h B.
fn factor_damped() {
    if (LONG_PATHS) {
        if (is_first() && !articulated_factor()) {
            fail(SINGULAR);
        }
        return;
    }
    copy_mass_to_factor();
    join();
    for (var i = member; i < bound(NV); i += TEAM) {
        add(QLD + pivot_of(i), added_inertia(i));
    }
    join();
    if (!factor_tree()) {
        fail(SINGULAR);
    }
}

// Computes the acceleration that advances the velocity: damping is implicit, so it solves (M + h B) a = τ + Jᵀf.
fn damped_acceleration() {
    if (!IMPLICIT_DAMPING) {
        for (var i = member; i < bound(NV); i += TEAM) {
            put(RATE + i, fetch(QACC + i));
        }
        return;
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        put(RATE + i, fetch(QFRC_SMOOTH + i) + fetch(QFRC_CONSTRAINT + i));
    }
    factor_damped();
    solve_tree(RATE);
}

// Advances activations, then velocities by the acceleration in RATE, then positions with the new velocities.
fn advance_semi_implicit() {
    advance_activations(ACT_DOT, ACTUATOR_VELOCITY);
    join();
    for (var i = member; i < bound(NV); i += TEAM) {
        var v = fetch_state(QVEL + i) + fetch(RATE + i) * TIMESTEP;
        if (SLEEP && !is_dof_awake(i)) {
            v = 0.0;
        }
        put_state(QVEL + i, v);
        put(RATE + i, v);
    }
    join();
    integrate_positions(RATE, TIMESTEP);
    finish_step(RATE, TEN_LENGTH, TEN_JACOBIAN);
}
