// Euler, implicit in the velocity derivatives of all smooth forces, Coriolis forces among them. Sister of `dynamics/implicit.rs`. One
// thread an environment.

@compute @workgroup_size(GROUP)
fn implicit(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    save_start();
    symmetric_inertia();
    for (var p = 0u; p < bound(NNZ); p++) {
        put(QLD_UPPER + p, fetch(QLD + p));
    }
    add_bias_derivatives();
    if (!factor_lu()) {
        trouble(SINGULAR);
    }
    solve_lu(RATE);
    advance_semi_implicit();
}
