// No-slip sweeps in a metric with terms of several dofs: as in MuJoCo they use the metric's backbone, and the effect of
// the forces in the whole metric is computed after them. CPU counterparts: `clench-solver/src/noslip.rs` and
// `metric_terms.rs`.

// Computes the acceleration of the constraint forces, from Jᵀf in CONSTRAINT_AT, with the factor in QLD: at the end
// `in_metric`, with the couplings. Nothing reads the forces of these afterwards.
fn accelerate(nblock: u32, in_metric: bool) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(QACC_AT + i, vector(CONSTRAINT_AT + i) - pull_of_couplings(i, nblock));
    }
    join_vectors();
    substitute_towards_root(QACC_AT);
    substitute_towards_leaves(QACC_AT);
    if (in_metric && NCOUPLING > 0u) {
        solve_couplings(QACC_AT);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(QACC_AT + i, vector(QACC_AT + i) + vector(SMOOTH_AT + i));
    }
    join_vectors();
}

// Returns true if any block that acts has friction.
fn any_friction(nblock: u32) -> bool {
    var count: f32 = 0.0;
    for (var b = lane; b < nblock; b += GROUP) {
        if (first_friction(b) != NONE && row(D + block(b, BLOCK_ROW)) > 0.0) {
            count += 1.0;
        }
    }
    return agreed(select(0u, 1u, total_of(count) > 0.0)) == 1u;
}
