// The mass matrix by composite rigid bodies, and its factor. Sister of `dynamics/inertia.rs`.

fn composite_inertia() {
    for (var k = 0u; k < bound(10u * NBODY); k++) {
        put(CRB + k, fetch(CINERT + k));
    }
    for (var b = NBODY - 1u; b > 0u; b--) {
        let parent = words[BODY_PARENT + b];
        if (parent != 0u) {
            for (var k = 0u; k < bound(10u); k++) {
                add(CRB + 10u * parent + k, fetch(CRB + 10u * b + k));
            }
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        let carried = momentum(CRB + 10u * words[DOF_BODY + i], fetch_spatial(CDOF + 6u * i));
        let end = words[TREE_START + i + 1u];
        for (var p = words[TREE_START + i]; p < end; p++) {
            put(QM + p, spatial_dot(fetch_spatial(CDOF + 6u * words[TREE_DOF + p]), carried));
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
    for (var p = 0u; p < bound(NNZ); p++) {
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
