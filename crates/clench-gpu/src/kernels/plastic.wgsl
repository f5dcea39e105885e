// Springs that yield. CPU counterpart: `dynamics/plastic.rs`.

// Returns the excess of an elongation over the yield, with its sign; 0 if the spring does not yield.
fn beyond(elongation: f32, limit: f32) -> f32 {
    if (limit <= 0.0 || abs(elongation) <= limit) {
        return 0.0;
    }
    return select(elongation + limit, elongation - limit, elongation > 0.0);
}

// Rotates the rest orientation of a ball joint's spring about the axis of its elongation, until that equals the yield.
fn yield_rotation(rest: u32, rotation: vec4f, limit: f32) {
    let old = fetch_state4(rest);
    let elongation = direction(quat_difference(quat_normalize(rotation), old));
    let too_far = beyond(elongation.w, limit);
    if (too_far > 0.0) {
        let turned = quat_normalize(quat_product(old, quat_from_axis_angle(elongation.xyz, too_far)));
        for (var k = 0u; k < 4u; k++) {
            put_state(rest + k, turned[k]);
        }
    }
}

// Returns true if no sleeping tree holds a tendon.
fn may_yield(t: u32) -> bool {
    return words[TENDON_ROW + t] == words[TENDON_ROW + t + 1u] || is_tendon_awake(t);
}

// Lets springs yield after a step that has moved the positions along the velocity at `velocity`, from tendon lengths
// and gradients at `length` and `jacobian` (all in work).
fn yield_springs(velocity: u32, length: u32, jacobian: u32) {
    for (var j = member; j < NJNT; j += TEAM) {
        if (words[JNT_PLASTIC + j] == NONE || (SLEEP && !is_dof_awake(words[JNT_DOF + j]))) {
            continue;
        }
        let rest = PLASTIC + words[JNT_PLASTIC + j];
        let q = QPOS + words[JNT_QPOS + j];
        let limit = parameter(JNT_YIELD + j);
        if (words[JNT_KIND + j] == BALL) {
            yield_rotation(rest, fetch_state4(q), limit);
        } else {
            put_state(rest, fetch_state(rest) + beyond(fetch_state(q) - fetch_state(rest), limit));
        }
    }
    for (var t = member; t < NTENDON; t += TEAM) {
        if (words[TENDON_PLASTIC + t] == NONE || (SLEEP && !may_yield(t))) {
            continue;
        }
        let band = PLASTIC + words[TENDON_PLASTIC + t];
        let end = fetch(length + t) + TIMESTEP * tendon_rate(t, velocity, jacobian);
        let moved = beyond(end - clamp(end, fetch_state(band), fetch_state(band + 1u)), parameter(TENDON_YIELD + t));
        put_state(band, fetch_state(band) + moved);
        put_state(band + 1u, fetch_state(band + 1u) + moved);
    }
}
