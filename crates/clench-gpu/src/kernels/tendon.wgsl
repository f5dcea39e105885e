// The length of each tendon and its gradient, a row over the dofs that change it. Sisters of `dynamics/tendon.rs` and
// `tendon_path.rs`.

fn fixed_tendon(t: u32) -> f32 {
    var length = 0.0;
    for (var k = words[TENDON_TERM + t]; k < words[TENDON_TERM + t + 1u]; k++) {
        let coef = parameter(TERM_COEF + k);
        length += coef * given(QPOS + words[TERM_QPOS + k]);
        put(TEN_JACOBIAN + words[TERM_ENTRY + k], coef);
    }
    return length;
}

// Adds the gradient of the length between the points `p` and `q` of two bodies; `pull` is the unit vector from one to the other,
// times the share of its length.
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
    var length = 0.0;
    for (var s = words[TENDON_SECTION + t]; s < words[TENDON_SECTION + t + 1u]; s++) {
        let start = words[SECTION_SITES + 2u * s];
        let to = words[SECTION_SITES + 2u * s + 1u];
        let share = parameter(SECTION_SHARE + s);
        let p = fetch3(SITE_XPOS + 3u * start);
        let q = fetch3(SITE_XPOS + 3u * to);
        let obstacle = words[SECTION_OBSTACLE + 2u * s];
        var wrapped = Wrapped(false, p, q, 0.0);
        if (ANY_OBSTACLE && obstacle != NONE) {
            wrapped = wrap(p, q, obstacle, words[SECTION_OBSTACLE + 2u * s + 1u]);
        }
        // A straight string is one span; one that touches a geom has a span to either side of it.
        for (var k = 0u; k < bound(select(1u, 2u, wrapped.touches)); k++) {
            var bodies = vec2u(words[SITE_BODY + start], words[SITE_BODY + to]);
            var first = p;
            var last = q;
            if (wrapped.touches && k == 0u) {
                bodies.y = words[GEOM_BODY + obstacle];
                last = wrapped.first;
            } else if (wrapped.touches) {
                bodies.x = words[GEOM_BODY + obstacle];
                first = wrapped.last;
                length += share * wrapped.length;
            }
            let apart = direction(last - first);
            length += share * apart.w;
            add_span(t, bodies.x, first, bodies.y, last, apart.xyz * share);
        }
    }
    return length;
}

fn tendons() {
    for (var t = 0u; t < NTENDON; t++) {
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            put(TEN_JACOBIAN + k, 0.0);
        }
        put(TEN_LENGTH + t, fixed_tendon(t) + spatial_tendon(t));
    }
}
