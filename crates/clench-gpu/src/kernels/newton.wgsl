// Newton's direction: −H⁻¹g with the Hessian of the current pieces. CPU counterpart: `clench-solver/src/newton.rs`.

// Factors H, unless no piece has changed.
fn factor_newton(same_hessian: bool, nblock: u32) {
    let rebuild = agreed(select(1u, 0u, same_hessian));
    if (rebuild == 1u) {
        factor_hessian(weigh_rows(nblock));
    }
}

// Computes the direction with the factor of H.
fn direct_newton() {
    for (var i = lane; i < bound(TILE * NTILE); i += GROUP) {
        put_vector(RAY_AT + i, select(0.0, -vector(GRADIENT_AT + i), i < NV));
    }
    join_vectors();
    solve_hessian(RAY_AT, MASS_RAY_AT);
}
