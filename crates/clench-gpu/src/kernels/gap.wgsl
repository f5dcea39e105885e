// The duality gap ½ gᵀM⁻¹g of the last solve, on request: one team per environment, even a stopped one. The cost minus
// ½ |a|²_M is convex, so that the cost exceeds its minimum by at most this. CPU counterpart:
// `clench-solver/src/descent.rs`.

@compute @workgroup_size(GROUP, TEAM)
fn gap(@builtin(global_invocation_id) id: vec3u) {
    select_environment(id.x);
    column = id.x % GROUP;
    member = select(BEHIND_ALL, id.y, env < envs);
    // An integrator may have stored its own factor there. If M is singular, the gap is NaN.
    _ = factor_mass();
    for (var i = member; i < bound(NV); i += TEAM) {
        put(PRECONDITIONED + i, fetch(GRADIENT + i));
    }
    join();
    substitute_towards_root(PRECONDITIONED);
    if (is_first()) {
        var square: f32 = 0.0;
        for (var i = 0u; i < bound(NV); i++) {
            let x = fetch(PRECONDITIONED + i);
            square += x * x * fetch(QLD_INVERSE + i);
        }
        reports[SOLVE_GAP * envs + env] = report_bits(0.5 * square);
    }
}
