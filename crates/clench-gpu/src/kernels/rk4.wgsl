// Fourth-order Runge–Kutta. CPU counterpart: `dynamics/rk4.rs`, which explains rotations. A step runs the whole forward
// pass four times, each followed by this kernel, which counts the stages in STAGE.

var<private> stage: u32;

// Returns the weight of a stage in the mean.
fn weight() -> f32 {
    return select(f32(1.0 / 3.0), f32(1.0 / 6.0), stage == 0u || stage == 3u);
}

// Returns the time from the start of the step to the stage after `s`.
fn reach(s: u32) -> f32 {
    return select(f32(0.5), f32(1.0), s == 2u) * TIMESTEP;
}

// Returns u̇ of the rotation vector u for the angular velocity ω.
fn increment_rate(u: vec3f, omega: vec3f) -> vec3f {
    let squared = dot(u, u);
    var c = 0.08333333333333333 + squared * (0.001388888888888889 + squared * (3.306878306878307e-5 + squared * 8.267195767195768e-7));
    if (squared >= 0.01) {
        let half = sqrt(squared) * 0.5;
        let t = sin_cos(half);
        c = (1.0 - half * t.y / t.x) / squared;
    }
    let turned = cross(u, omega);
    return omega + turned * 0.5 + cross(u, turned) * c;
}

// Computes the rates of this stage: of positions in RATE, which holds those of the previous stage.
fn collect_rates() {
    for (var j = member; j < bound(NJNT); j += TEAM) {
        let kind = words[JNT_KIND + j];
        let first = words[JNT_DOF + j];
        let end = words[JNT_DOF + j + 1u];
        var increment = vec3f();
        if (kind == BALL || kind == FREE) {
            increment = fetch3(RATE + end - 3u) * reach(max(stage, 1u) - 1u);
        }
        for (var i = first; i < end; i++) {
            put(RATE + i, fetch_state(QVEL + i));
        }
        if ((kind == BALL || kind == FREE) && stage > 0u) {
            put3(RATE + end - 3u, increment_rate(increment, fetch_state3(QVEL + end - 3u)));
        }
    }
}

fn add_to_mean() {
    for (var i = member; i < bound(NV); i += TEAM) {
        let before = stage > 0u;
        put(MEAN_RATE + i, select(0.0, fetch(MEAN_RATE + i), before) + weight() * fetch(RATE + i));
        put(MEAN_QACC + i, select(0.0, fetch(MEAN_QACC + i), before) + weight() * fetch(QACC + i));
    }
    for (var a = member; a < NA; a += TEAM) {
        let mean = select(0.0, fetch(MEAN_ACT_DOT + a), stage > 0u);
        put(MEAN_ACT_DOT + a, mean + weight() * fetch(ACT_DOT + a));
    }
}

// Advances the state by `time` seconds, with the rates in `rate` (in work) and accelerations in `qacc`.
fn go(rate: u32, qacc: u32, time: f32) {
    for (var i = member; i < bound(NV); i += TEAM) {
        put_state(QVEL + i, fetch_state(QVEL + i) + fetch(qacc + i) * time);
    }
    integrate_positions(rate, time);
}

// Saves the lengths and gradients of tendons that yield or stick.
fn save_tendons() {
    for (var t = member; (YIELDING_TENDONS || STICTION) && t < NTENDON; t += TEAM) {
        put(START_TEN_LENGTH + t, fetch(TEN_LENGTH + t));
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            put(START_TEN_JACOBIAN + k, fetch(TEN_JACOBIAN + k));
        }
    }
}

@compute @workgroup_size(GROUP, TEAM)
fn runge_kutta(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    stage = u32(fetch(STAGE));
    join();
    if (is_first()) {
        put(STAGE, f32((stage + 1u) % 4u));
        put(OFFSET, select(reach(stage), 0.0, stage == 3u));
    }
    if (stage == 0u) {
        save_start();
        for (var o = member; o < NOUT; o += TEAM) {
            put(START_ACTUATOR_VELOCITY + o, fetch(ACTUATOR_VELOCITY + o));
        }
        save_tendons();
    }
    collect_rates();
    join();
    add_to_mean();
    restore_start();
    join();
    if (stage < 3u) {
        go(RATE, QACC, reach(stage));
        for (var a = member; a < NA; a += TEAM) {
            put_state(ACT + a, fetch_state(ACT + a) + fetch(ACT_DOT + a) * reach(stage));
        }
        // The previous stage is closer than the last step.
        for (var i = member; i < bound(NV); i += TEAM) {
            put_state(QACC_WARMSTART + i, fetch(QACC + i));
        }
        // The remaining work is for the last stage only. Excluded environments have no stage, so this thread waits as
        // theirs do.
        member = BEHIND_ALL;
    }
    go(MEAN_RATE, MEAN_QACC, TIMESTEP);
    // As in MuJoCo, the bristles of a motor's friction bend with the velocity at the start of the step.
    advance_activations(MEAN_ACT_DOT, START_ACTUATOR_VELOCITY);
    finish_step(MEAN_RATE, START_TEN_LENGTH, START_TEN_JACOBIAN);
}
