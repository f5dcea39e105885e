// The inverse inertia of rows in the current configuration, instead of an estimate at the initial one. CPU counterpart:
// `constraint/exact.rs`. D holds the impedance of the row's block until it is set.

// Returns J M⁻¹ Jᵀ of row `a` plus `factor` times row `other`. Overwrites WEIGHED of the first. The metric's backbone
// replaces M.
fn inverse_inertia(a: u32, other: u32, factor: f32) -> f32 {
    let lower = select(QLD, BACKBONE, HAS_BACKBONE);
    let inverse = select(QLD_INVERSE, BACKBONE_INVERSE, HAS_BACKBONE);
    let x = WEIGHED + a * NV;
    for (var i = 0u; i < bound(NV); i++) {
        put_row(x + i, row(JACOBIAN + a * NV + i) + factor * row(JACOBIAN + other * NV + i));
    }
    var sum: f32 = 0.0;
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let value = row(x + i);
        sum += value * value * fetch(inverse + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            let above = x + words[TREE_DOF + p];
            put_row(above, row(above) - fetch(lower + p) * value);
        }
    }
    return sum;
}

// Replaces R of the rows of a block. In a cone one row decides, and the others keep their ratio to it: the normal of an
// elliptic one, the first edge of a pyramid.
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
