// Springs that yield. CPU counterpart: `dynamics/plastic.rs`.

// Returns the excess of an elongation over the yield, with its sign; 0 if the spring does not yield.
fn beyond(stretch: f32, most: f32) -> f32 {
    if (most <= 0.0 || abs(stretch) <= most) {
        return 0.0;
    }
    return select(stretch + most, stretch - most, stretch > 0.0);
}

// Rotates the rest orientation of a ball joint's spring about the axis of its elongation, until that equals the yield.
fn turn_rest(rest: u32, turn: vec4f, most: f32) {
    let old = given4(rest);
    let stretch = direction(quat_difference(quat_normalize(turn), old));
    let too_far = beyond(stretch.w, most);
    if (too_far > 0.0) {
        let turned = quat_normalize(quat_product(old, quat_from_axis_angle(stretch.xyz, too_far)));
        for (var k = 0u; k < 4u; k++) {
            keep(rest + k, turned[k]);
        }
    }
}

// Lets springs yield after a step that has moved the positions along the velocity at `velocity`, from tendon lengths
// and gradients at `length` and `jacobian` (all in work).
fn yield_springs(velocity: u32, length: u32, jacobian: u32) {
    for (var j = member; j < NJNT; j += TEAM) {
        if (words[JNT_PLASTIC + j] == NONE) {
            continue;
        }
        let rest = PLASTIC + words[JNT_PLASTIC + j];
        let q = QPOS + words[JNT_QPOS + j];
        let most = parameter(JNT_YIELD + j);
        if (words[JNT_KIND + j] == BALL) {
            turn_rest(rest, given4(q), most);
        } else {
            keep(rest, given(rest) + beyond(given(q) - given(rest), most));
        }
    }
    for (var t = member; t < NTENDON; t += TEAM) {
        if (words[TENDON_PLASTIC + t] == NONE) {
            continue;
        }
        let band = PLASTIC + words[TENDON_PLASTIC + t];
        var rate: f32 = 0.0;
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            rate += fetch(jacobian + k) * fetch(velocity + words[TENDON_DOF + k]);
        }
        let end = fetch(length + t) + TIMESTEP * rate;
        let moved = beyond(end - clamp(end, given(band), given(band + 1u)), parameter(TENDON_YIELD + t));
        keep(band, given(band) + moved);
        keep(band + 1u, given(band + 1u) + moved);
    }
}
