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
}

fn restore_start() {
    for (var i = 0u; i < bound(NQ); i++) {
        keep(QPOS + i, fetch(START_QPOS + i));
    }
    for (var i = 0u; i < bound(NV); i++) {
        keep(QVEL + i, fetch(START_QVEL + i));
    }
}

fn is_far(x: f32) -> bool {
    return is_wild(x) || abs(x) > 1e10;
}

// Lets the step count, or takes it back where it led nowhere.
fn finish_step() {
    var far = false;
    for (var i = 0u; i < bound(NV); i++) {
        far = far || is_far(fetch(QACC + i)) || is_wild(fetch(QFRC_CONSTRAINT + i)) || is_far(given(QVEL + i));
        keep(QACC_WARMSTART + i, fetch(QACC + i));
    }
    for (var i = 0u; i < bound(NQ); i++) {
        far = far || is_far(given(QPOS + i));
    }
    if (far) {
        trouble(DIVERGED);
    }
    let fault = reports[TROUBLE * N + env];
    if (fault == RUNNING) {
        reports[STEPS * N + env] += 1u;
        return;
    }
    reports[STATUS * N + env] = fault;
    restore_start();
    for (var i = 0u; i < bound(NV); i++) {
        keep(QACC_WARMSTART + i, fetch(START_WARMSTART + i));
    }
}

// The acceleration that advances the velocity: damping is implicit, so it solves (M + h B) a = τ + Jᵀf.
fn damped_acceleration() {
    if (!IMPLICIT_DAMPING) {
        for (var i = 0u; i < bound(NV); i++) {
            put(RATE + i, fetch(QACC + i));
        }
        return;
    }
    for (var p = 0u; p < bound(NNZ); p++) {
        put(QLD + p, fetch(QM + p));
    }
    for (var i = 0u; i < bound(NV); i++) {
        let law = number3(DOF_DAMPER + 3u * i);
        let v = abs(given(QVEL + i));
        let slope = law.x + v * (2.0 * law.y + v * 3.0 * law.z);
        add(QLD + words[TREE_START + i + 1u] - 1u, TIMESTEP * slope);
        put(RATE + i, fetch(QFRC_SMOOTH + i) + fetch(QFRC_CONSTRAINT + i));
    }
    if (!factor_tree()) {
        trouble(SINGULAR);
    }
    solve_tree(RATE);
}

// Semi-implicit Euler: one thread an environment.
@compute @workgroup_size(GROUP)
fn euler(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    save_start();
    damped_acceleration();
    for (var i = 0u; i < bound(NV); i++) {
        let v = given(QVEL + i) + fetch(RATE + i) * TIMESTEP;
        keep(QVEL + i, v);
        put(RATE + i, v);
    }
    integrate_positions(RATE, TIMESTEP);
    finish_step();
}
