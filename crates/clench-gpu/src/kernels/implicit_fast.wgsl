// Euler, implicit in the velocity derivatives of damping, medium and actuation. Sister of `dynamics/implicit.rs`. One thread an
// environment.

@compute @workgroup_size(GROUP)
fn implicit_fast(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    save_start();
    symmetric_inertia();
    gyroscopic_accelerations();
    if (!factor_tree()) {
        trouble(SINGULAR);
    }
    solve_tree(RATE);
    for (var k = 0u; k < NFREE_TREE; k++) {
        let dof = words[JNT_DOF + words[FREE_TREE_JNT + k]];
        for (var r = 0u; r < bound(6u); r++) {
            put(RATE + dof + r, fetch(MEAN_RATE + dof + r));
        }
    }
    advance_semi_implicit();
}
