// The inverse inertia that rows see in the present configuration, instead of an estimate at the initial one. Sister of
// `constraint/exact.rs`. Until a row has its D, that holds the impedance of its block.

// J M⁻¹ Jᵀ of row `a` and `factor` times row `other`. WEIGHED of the first is used up.
fn inverse_inertia(a: u32, other: u32, factor: f32) -> f32 {
    let x = WEIGHED + a * NV;
    for (var i = 0u; i < bound(NV); i++) {
        put_row(x + i, row(JACOBIAN + a * NV + i) + factor * row(JACOBIAN + other * NV + i));
    }
    var sum: f32 = 0.0;
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let value = row(x + i);
        sum += value * value * fetch(QLD_INVERSE + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            let above = x + words[TREE_DOF + p];
            put_row(above, row(above) - fetch(QLD + p) * value);
        }
    }
    return sum;
}

// Replaces R of the rows of a block. Of a cone one row decides, and the others keep their ratio to it: of an elliptic one the normal, of a
// pyramid its first edge.
fn regularize_exactly(kind: u32, first: u32, dim: u32) {
    let d = row(D + first);
    let is_pyramid = kind == CONTACT_PYRAMID;
    let is_cone = is_pyramid || kind == CONTACT_ELLIPTIC;
    for (var a = first; a < first + select(dim, 1u, is_cone); a++) {
        let mu = select(0.0, row(SHAPE + min(a + 1u, first + dim - 1u)), is_pyramid);
        let plain = regularization(d, inverse_inertia(a, select(a, a + 1u, is_pyramid), mu));
        let r = select(plain, 2.0 * (mu * mu / IMPRATIO) * plain, is_pyramid);
        let larger = r / row(R + a);
        put_row(R + a, r);
        for (var k = first + 1u; is_cone && k < first + dim; k++) {
            put_row(R + k, row(R + k) * larger);
        }
    }
}
