// Accelerations of awake free bodies that are trees of their own, with their gyroscopic forces, if neither constraints
// nor terms of the metric act on them: one team per environment. CPU counterpart: `spin_freely` in
// `dynamics/discrete.rs`.

// Returns true if a row that acts, or a term of the metric, involves dof `i`.
fn is_touched(i: u32) -> bool {
    if (fetch(TOUCHED + i) != 0.0) {
        return true;
    }
    for (var a = 0u; a < reports[NROW * envs + env]; a++) {
        if (row(D + a) > 0.0 && row(COLUMNS + i * MAX_ROWS + a) != 0.0) {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(GROUP, TEAM)
fn spin(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    for (var i = member; i < bound(NV); i += TEAM) {
        put(RATE + i, fetch(QFRC_SMOOTH + i) + fetch(SHIFT + i));
    }
    join();
    gyroscopic_accelerations(QM);
    join();
    for (var k = member; k < NFREE_TREE; k += TEAM) {
        let dof = words[JNT_DOF + words[FREE_TREE_JNT + k]];
        if (SLEEP && !is_dof_awake(dof)) {
            continue;
        }
        var touched = false;
        for (var r = 0u; r < bound(6u) && !touched; r++) {
            touched = is_touched(dof + r);
        }
        for (var r = 0u; !touched && r < bound(6u); r++) {
            put(QACC + dof + r, fetch(MEAN_RATE + dof + r));
        }
    }
    end_in_team();
}
