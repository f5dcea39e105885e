// Springs, dampers, gravity compensation, the medium, and contact adhesion. CPU counterparts: `dynamics/passive.rs`,
// `polynomial.rs` and `fluid.rs`.
//
// The force of a spring is −(a x + b x² + c x³), that of a damper −(a v + b v |v| + c v³).

// Adds the force of a spring with the elongation `elongation` to three dofs.
fn pull_back(law: vec3f, elongation: vec3f, qfrc: u32) {
    let k = stiffness(law, length(elongation));
    put3(qfrc, fetch3(qfrc) - elongation * k);
}

fn springs() {
    for (var s = member; s < NSPRING; s += TEAM) {
        let j = words[SPRING_JNT + s];
        let law = parameter3(SPRING_LAW + 3u * s);
        let q = words[JNT_QPOS + j];
        let kind = words[JNT_KIND + j];
        var qfrc = QFRC_PASSIVE + words[JNT_DOF + j];
        if (kind == SLIDE || kind == HINGE) {
            let x = joint_displacement(j, q);
            add(qfrc, -x * stiffness(law, x));
            continue;
        }
        var rotation = q;
        if (kind == FREE) {
            pull_back(law, joint_shift(j, q), qfrc);
            rotation += 3u;
            qfrc += 3u;
        }
        pull_back(law, joint_rotation(j, rotation), qfrc);
    }
}

// Computes the first force on dofs.
fn dampers() {
    for (var i = member; i < bound(NV); i += TEAM) {
        let v = fetch_state(QVEL + i);
        put(QFRC_PASSIVE + i, -v * stiffness(parameter3(DOF_DAMPER + 3u * i), abs(v)));
    }
}

// Tendons share dofs, so one thread adds them all.
fn tendon_forces() {
    for (var t = 0u; is_first() && t < NTENDON; t++) {
        let force = tendon_passive_force(t);
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            add(QFRC_PASSIVE + words[TENDON_DOF + k], fetch(TEN_JACOBIAN + k) * force);
        }
    }
}

// Returns −(c₁ v + c₂ |v| v), axis by axis.
fn resistance(viscous: vec3f, quadratic: vec3f, v: vec3f) -> vec3f {
    return -(viscous * v + quadratic * abs(v) * v);
}

// Computes the resistance to the box with a body's mass and inertia, whose coefficients are parameters, or to the
// body's ellipsoids.
fn fluid_forces() {
    for (var b = member; b < bound(NBODY); b += TEAM) {
        if (has_ellipsoids(b)) {
            put_spatial(CFRC + 6u * b, ellipsoids_force(b));
            continue;
        }
        let axes = fetch_matrix(XIMAT + 9u * b);
        let back = transpose(axes);
        let arm = fetch3(XIPOS + 3u * b) - fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
        let cvel = fetch_spatial(CVEL + 6u * b);
        let angular = back * cvel.angular;
        let linear = back * (cvel.linear + cross(cvel.angular, arm) - parameter3(WIND));
        let drag = BODY_DRAG + 12u * b;
        let torque = resistance(parameter3(drag), parameter3(drag + 6u), angular);
        let force = resistance(parameter3(drag + 3u), parameter3(drag + 9u), linear);
        put_spatial(CFRC + 6u * b, force_at_com(b, axes * force, axes * torque));
    }
    join();
    project_forces(QFRC_PASSIVE);
}

// Applies the compensated share of each body's weight at its centre of mass; `BODY_LIFT` is its mass times that share.
fn gravity_compensation() {
    clear_dofs(QFRC_GRAVCOMP);
    for (var b = member; b < bound(NBODY); b += TEAM) {
        let lift = parameter3(GRAVITY) * -parameter(BODY_LIFT + b);
        put_spatial(CFRC + 6u * b, force_at_com(b, lift, vec3f()));
    }
    join();
    project_forces(QFRC_GRAVCOMP);
    for (var i = member; i < bound(NV); i += TEAM) {
        if (words[DOF_ACTGRAVCOMP + i] == 0u) {
            add(QFRC_PASSIVE + i, fetch(QFRC_GRAVCOMP + i));
        }
    }
}

// Applies the adhesion of contacts, which pulls their bodies together against the corresponding constraint forces.
fn adhesion_forces() {
    for (var b = member; b < bound(NBODY); b += TEAM) {
        put_spatial(CFRC + 6u * b, Spatial(vec3f(), vec3f()));
    }
    join();
    // Contacts share bodies, so one thread adds them all.
    for (var c = 0u; is_first() && c < reports[NCON * envs + env]; c++) {
        let offset = CONTACTS + CONTACT_SIZE * c;
        let pair = u32(fetch(offset));
        let adhesion = contact_adhesion(c);
        for (var side = 0u; side < 2u; side++) {
            let b = words[PAIR_BODY + 2u * pair + side];
            let force = fetch3(offset + 5u) * select(adhesion, -adhesion, side == 1u);
            let pull = Spatial(cross(offset_of(b, fetch3(offset + 2u)), force), force);
            put_spatial(CFRC + 6u * b, plus(fetch_spatial(CFRC + 6u * b), pull));
        }
    }
    join();
    project_forces(QFRC_PASSIVE);
}

fn passive_forces() {
    dampers();
    if (NSPRING > 0u) {
        join();
        springs();
    }
    if (NTENDON > 0u) {
        join();
        tendon_forces();
    }
    join();
    if (HAS_GRAVCOMP) {
        gravity_compensation();
    }
    if (HAS_FLUID) {
        fluid_forces();
    }
    if (ADHESION_PULLS) {
        adhesion_forces();
    }
}
