// Euler, implicit in the velocity derivatives of all smooth forces including Coriolis forces. CPU counterpart:
// `dynamics/implicit.rs`. One team per environment, of which one thread factors and solves.

@compute @workgroup_size(GROUP, TEAM)
fn implicit(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    save_start();
    symmetric_inertia();
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(QLD_UPPER + p, fetch(QLD + p));
    }
    join();
    if (is_first()) {
        add_bias_derivatives();
        if (!factor_lu()) {
            fail(SINGULAR);
        }
        solve_lu(RATE);
    }
    advance_semi_implicit();
}
