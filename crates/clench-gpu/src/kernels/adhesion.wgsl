// Transmissions to contacts: a body is attracted to everything that it touches. CPU counterpart:
// `dynamics/adhesion.rs`.

// Computes the moment arms, over all dofs, of an actuator on the contacts of `body`: minus the mean separation rate of
// the bodies there. A contact within one rigid body has no share, unless it is within the gap.
fn contact_arms(u: u32, body: u32) {
    let arms = ACTUATOR_MOMENT + first_arm(u);
    for (var i = 0u; i < bound(NV); i++) {
        put(arms + i, 0.0);
    }
    var count: f32 = 0.0;
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        let offset = CONTACTS + CONTACT_SIZE * c;
        let pair = u32(fetch(offset));
        let a = words[PAIR_BODY + 2u * pair];
        let b = words[PAIR_BODY + 2u * pair + 1u];
        if (a != body && b != body) {
            continue;
        }
        let margin = parameter(PAIR_PRM + PAIR_SIZE * pair + PAIR_MARGIN);
        let acts = fetch(offset + 1u) < margin || contact_adhesion(c) != 0.0;
        if (move_together(a, b) && acts) {
            continue;
        }
        count += 1.0;
        let position = fetch3(offset + 2u);
        let normal = fetch3(offset + 5u);
        for (var i = 0u; i < bound(NV); i++) {
            let second = moves(b, i);
            if (moves(a, i) != second) {
                let motion = motion_at(select(a, b, second), i, position);
                add(arms + i, dot(select(normal, -normal, second), motion.linear));
            }
        }
    }
    for (var i = 0u; count > 0.0 && i < bound(NV); i++) {
        put(arms + i, fetch(arms + i) * (1.0 / count));
    }
}

fn adhesion() {
    for (var u = member; u < NU; u += TEAM) {
        if (words[ACTUATOR_ON + u] == ON_CONTACTS) {
            contact_arms(u, words[ACTUATOR_TARGET + 2u * u]);
        }
    }
    join();
}
