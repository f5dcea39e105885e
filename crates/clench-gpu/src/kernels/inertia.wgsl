// The mass matrix by composite rigid bodies, and its factor. Sister of `dynamics/inertia.rs`.

// The ten numbers of an inertia, read and written together: a card that waits for each by itself waits long.
struct Inertia {
    first: vec4f,
    second: vec4f,
    third: vec2f,
}

fn fetch_inertia(place: u32) -> Inertia {
    return Inertia(fetch4(place), fetch4(place + 4u), vec2f(fetch(place + 8u), fetch(place + 9u)));
}

fn put_inertia(place: u32, inertia: Inertia) {
    put4(place, inertia.first);
    put4(place + 4u, inertia.second);
    put(place + 8u, inertia.third.x);
    put(place + 9u, inertia.third.y);
}

fn composite_inertia() {
    for (var b = 0u; b < bound(NBODY); b++) {
        put_inertia(CRB + 10u * b, fetch_inertia(CINERT + 10u * b));
    }
    for (var b = NBODY - 1u; b > 0u; b--) {
        let parent = words[BODY_PARENT + b];
        if (parent != 0u) {
            let carried = fetch_inertia(CRB + 10u * parent);
            let own = fetch_inertia(CRB + 10u * b);
            put_inertia(CRB + 10u * parent, Inertia(carried.first + own.first, carried.second + own.second, carried.third + own.third));
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        let carried = momentum(CRB + 10u * words[DOF_BODY + i], fetch_spatial(CDOF + 6u * i));
        let end = words[TREE_START + i + 1u];
        // Two at a time, of which the last may be the same.
        for (var p = words[TREE_START + i]; p < end; p += 2u) {
            let next = min(p + 1u, end - 1u);
            let axis = fetch_spatial(CDOF + 6u * words[TREE_DOF + p]);
            let next_axis = fetch_spatial(CDOF + 6u * words[TREE_DOF + next]);
            put(QM + p, spatial_dot(axis, carried));
            put(QM + next, spatial_dot(next_axis, carried));
        }
        add(QM + end - 1u, parameter(DOF_ARMATURE + i));
    }
}

// Adds the inertia of all tendons. Sister of `dynamics/tendon_armature.rs`.
fn add_tendon_inertia() {
    for (var t = 0u; t < NTENDON; t++) {
        let armature = parameter(TENDON_ARMATURE + t);
        add_outer(QM, TENDON_DOF, TEN_JACOBIAN, words[TENDON_ROW + t], words[TENDON_ROW + t + 1u], armature);
    }
}

// Nothing is added to the diagonal of M.
fn added_inertia(i: u32) -> f32 {
    return 0.0;
}

fn factor_mass() {
    if (LONG_PATHS) {
        if (!articulated_factor()) {
            trouble(SINGULAR);
        }
        return;
    }
    let whole = NNZ - NNZ % 4u;
    for (var p = 0u; p < bound(whole); p += 4u) {
        put4(QLD + p, fetch4(QM + p));
    }
    for (var p = whole; p < bound(NNZ); p++) {
        put(QLD + p, fetch(QM + p));
    }
    if (!factor_tree()) {
        trouble(SINGULAR);
    }
}

// What depends on positions alone: one thread an environment.
@compute @workgroup_size(GROUP)
fn positions(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    kinematics();
    com_positions();
    composite_inertia();
    tendons();
    transmissions();
    if (HEAVY_TENDONS) {
        add_tendon_inertia();
    }
    factor_mass();
    note_end();
}
