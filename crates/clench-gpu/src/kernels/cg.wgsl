// Conjugate gradients, preconditioned by the mass matrix. CPU counterpart: `clench-solver/src/cg.rs`, which explains
// the restarts.

// Computes the next direction, conjugate to the last one; or, on a restart, M⁻¹ times the negative gradient.
fn direct_conjugate(started: bool) {
    var products = vec4f();
    for (var i = lane; i < bound(NV); i += GROUP) {
        let last = vector(LAST_PRECONDITIONED_AT + i);
        let gradient = vector(GRADIENT_AT + i);
        products += vec4f(vector(LAST_GRADIENT_AT + i) * last, gradient * last, gradient * vector(PRECONDITIONED_AT + i), 0.0);
    }
    let sums = total(products);
    let before = sums.x;
    let overlap = sums.y;
    let now = sums.z;
    let conjugate = started && abs(overlap) < CG_OVERLAP * now && before > 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        let preconditioned = vector(PRECONDITIONED_AT + i);
        var ray = -preconditioned;
        if (conjugate) {
            ray += (now - overlap) / before * vector(RAY_AT + i);
        }
        put_vector(RAY_AT + i, ray);
        put_vector(LAST_PRECONDITIONED_AT + i, preconditioned);
        put_vector(LAST_GRADIENT_AT + i, vector(GRADIENT_AT + i));
    }
    join_vectors();
}
