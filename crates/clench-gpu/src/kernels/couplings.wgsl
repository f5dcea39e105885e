// Solutions in a metric that couples dofs of different branches, by Woodbury's identity with the factor of the part
// without couplings. CPU counterparts: `clench-solver/src/metric_terms.rs`, and `couple_smooth` in
// `dynamics/discrete.rs`, which finds the same minimum by Newton's method.
//
// Teams and workgroups share this text and `substitution.wgsl`, with the same interface.

// Adds −(M̂⁻¹Jᵀ)(I + J M̂⁻¹Jᵀ)⁻¹ J x to x = M̂⁻¹q, with J the rows √s jᵀ of the couplings. COUPLING_PULL holds the
// solution of the small system afterwards.
fn solve_couplings(x: u32) {
    for (var k = worker(); k < NCOUPLING; k += workers()) {
        let arms = arms_along(words[COUPLING_ALONG + k]);
        var sum: f32 = 0.0;
        for (var n = arms.start; n < arms.end; n++) {
            sum += fetch(arms.entries + n) * unknown(x, words[arms.dofs + n]);
        }
        put(COUPLING_PULL + k, sqrt(coupling_scale(k)) * sum);
    }
    join();
    if (worker() == 0u) {
        solve_gram();
    }
    join();
    for (var i = worker(); i < bound(NV); i += workers()) {
        var rest = unknown(x, i);
        for (var k = 0u; k < NCOUPLING; k++) {
            rest -= fetch(COUPLING_RESPONSE + k * NV + i) * fetch(COUPLING_PULL + k);
        }
        put_unknown(x, i, rest);
    }
    join_unknowns();
}

// Solves with the Cholesky factor in COUPLING_GRAM: forwards, then backwards.
fn solve_gram() {
    for (var i = 0u; i < NCOUPLING; i++) {
        var rest = fetch(COUPLING_PULL + i);
        for (var k = 0u; k < i; k++) {
            rest -= fetch(COUPLING_GRAM + i * NCOUPLING + k) * fetch(COUPLING_PULL + k);
        }
        put(COUPLING_PULL + i, rest / fetch(COUPLING_GRAM + i * NCOUPLING + i));
    }
    for (var up = 0u; up < NCOUPLING; up++) {
        let i = NCOUPLING - 1u - up;
        var rest = fetch(COUPLING_PULL + i);
        for (var k = i + 1u; k < NCOUPLING; k++) {
            rest -= fetch(COUPLING_GRAM + k * NCOUPLING + i) * fetch(COUPLING_PULL + k);
        }
        put(COUPLING_PULL + i, rest / fetch(COUPLING_GRAM + i * NCOUPLING + i));
    }
}
