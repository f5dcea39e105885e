// Rows whose spring-damper is evaluated at the end of the step, in the metric of the integrator `discrete`. CPU
// counterparts: `constraint/implicit.rs`, and `constraint/softness.rs`, which derives the formulas.

// Returns the reference acceleration of a row at a velocity.
fn reference_at_end(a: u32, velocity: f32) -> f32 {
    let rate = row(DAMPING + a) + TIMESTEP * row(STIFFNESS + a);
    return (row(AREF + a) - rate * velocity) / beta(a);
}

// Returns Σ Jᵢ² / M̂ᵢᵢ over Σ Jᵢ² / Mᵢᵢ of row `a` plus `factor` times row `other`; 1 if it is zero up to rounding.
fn inverse_inertia_ratio(a: u32, other: u32, factor: f32) -> f32 {
    var before: f32 = 0.0;
    var after: f32 = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        let arm = row(JACOBIAN + a * NV + i) + factor * row(JACOBIAN + other * NV + i);
        let inertia = fetch(PLAIN_MASS + words[TREE_START + i + 1u] - 1u);
        before += arm * arm / inertia;
        after += arm * arm / (inertia + fetch(ADDED + i));
    }
    return select(1.0, after / before, before > LEAST);
}

// Returns the factor of R of a row in a block of impedance `d`.
fn end_factor(a: u32, other: u32, factor: f32, d: f32) -> f32 {
    let least = d * (1.0 - MAX_IMPEDANCE) / (MAX_IMPEDANCE * (1.0 - d));
    let ratio = max(1.0 / beta(a), least);
    if (EXACT_DIAGONAL) {
        return ratio;
    }
    return ratio * inverse_inertia_ratio(a, other, factor);
}

// Updates R of the rows of a block. In a cone the first decides, and the others keep their ratio to it.
fn regularize_at_end(kind: u32, first: u32, dim: u32) {
    let d = row(D + first);
    let is_pyramid = kind == CONTACT_PYRAMID;
    if (!is_pyramid && kind != CONTACT_ELLIPTIC) {
        for (var a = first; a < first + dim; a++) {
            put_row(R + a, max(row(R + a) * end_factor(a, a, 0.0, d), LEAST));
        }
        return;
    }
    let mu = select(0.0, row(SHAPE + first + 1u), is_pyramid);
    // Converts R to that of the normal's inverse inertia, which the minimum applies to.
    let unit = select(1.0, 1.0 / (2.0 * (mu * mu / IMPRATIO)), is_pyramid);
    let normal = row(R + first) * unit;
    let larger = max(normal * end_factor(first, select(first, first + 1u, is_pyramid), mu, d), LEAST) / normal;
    for (var a = first; a < first + dim; a++) {
        put_row(R + a, row(R + a) * larger);
    }
}
