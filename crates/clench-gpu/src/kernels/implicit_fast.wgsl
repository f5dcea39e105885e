// Euler, implicit in the velocity derivatives of damping, medium and actuation. CPU counterpart:
// `dynamics/implicit.rs`. One team per environment.

@compute @workgroup_size(GROUP, TEAM)
fn implicit_fast(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    save_start();
    symmetric_inertia();
    gyroscopic_accelerations(QLD);
    join();
    if (!factor_tree()) {
        fail(SINGULAR);
    }
    solve_tree(RATE);
    join();
    for (var k = member; k < NFREE_TREE; k += TEAM) {
        let dof = words[JNT_DOF + words[FREE_TREE_JNT + k]];
        for (var r = 0u; r < bound(6u); r++) {
            put(RATE + dof + r, fetch(MEAN_RATE + dof + r));
        }
    }
    advance_semi_implicit();
}
