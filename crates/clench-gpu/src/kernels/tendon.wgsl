// The length of each tendon and its gradient, a row over the dofs that change it. CPU counterparts:
// `dynamics/tendon.rs` and `tendon_path.rs`.

fn fixed_tendon(t: u32) -> f32 {
    var length: f32 = 0.0;
    for (var k = words[TENDON_TERM + t]; k < words[TENDON_TERM + t + 1u]; k++) {
        let coef = parameter(TERM_COEF + k);
        length += coef * fetch_state(QPOS + words[TERM_QPOS + k]);
        put(TEN_JACOBIAN + words[TERM_ENTRY + k], coef);
    }
    return length;
}

// Adds the gradient of the length between the points `p` and `q` of two bodies; `pull` is the unit vector from one to
// the other, times the factor of its length.
fn add_span(t: u32, a: u32, p: vec3f, b: u32, q: vec3f, pull: vec3f) {
    for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
        let dof = words[TENDON_DOF + k];
        let second = moves(b, dof);
        if (moves(a, dof) != second) {
            let motion = motion_at(select(a, b, second), dof, select(p, q, second));
            add(TEN_JACOBIAN + k, dot(select(-pull, pull, second), motion.linear));
        }
    }
}

fn spatial_tendon(t: u32) -> f32 {
    var length: f32 = 0.0;
    for (var s = words[TENDON_SECTION + t]; s < words[TENDON_SECTION + t + 1u]; s++) {
        let share = parameter(SECTION_SHARE + s);
        let path = section_path(s);
        length += select(0.0, share * path.length, path.touches);
        for (var k = 0u; k < bound(span_count(path)); k++) {
            let span = span_of(s, path, k);
            let apart = direction(span.last - span.first);
            length += share * apart.w;
            add_span(t, span.bodies.x, span.first, span.bodies.y, span.last, apart.xyz * share);
        }
    }
    return length;
}

fn tendons() {
    for (var t = member; t < NTENDON; t += TEAM) {
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            put(TEN_JACOBIAN + k, 0.0);
        }
        put(TEN_LENGTH + t, fixed_tendon(t) + spatial_tendon(t));
    }
}
