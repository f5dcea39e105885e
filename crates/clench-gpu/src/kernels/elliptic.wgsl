// Frictional contact with the exact cone. CPU counterpart: `clench-solver/src/costs/elliptic.rs`, which derives the
// formulas.

// A block at y + α dy, in coordinates in which its cone is circular.
struct Zone {
    k: f32,
    mu: f32,
    // N − μT and μN + T, each if negative.
    p: f32,
    q: f32,
    // 1 / T, 0 without slip.
    inverse: f32,
    // μ² − μ N/T in the middle zone.
    c: f32,
    // 0 top, 1 middle, 2 bottom.
    piece: u32,
}

fn scaled_residual(a: u32, alpha: f32) -> f32 {
    return row(SHAPE + a) * (row(RESIDUAL + a) + alpha * row(RAY + a));
}

fn zone(first: u32, dim: u32, alpha: f32) -> Zone {
    let mu = row(SHAPE + first);
    let k = row(D + first) / (mu * mu * (1.0 + mu * mu));
    let n = mu * (row(RESIDUAL + first) + alpha * row(RAY + first));
    var t2: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        let u = scaled_residual(a, alpha);
        t2 += u * u;
    }
    let t = sqrt(t2);
    let inverse = select(0.0, 1.0 / max(t, SMALLEST), t > 0.0);
    let above = n - mu * t;
    let below = mu * n + t;
    if (above >= 0.0) {
        return Zone(k, mu, 0.0, 0.0, inverse, 0.0, 0u);
    }
    if (below <= 0.0) {
        return Zone(k, mu, above, below, inverse, 0.0, 2u);
    }
    return Zone(k, mu, above, 0.0, inverse, mu * mu - mu * n * inverse, 1u);
}

fn evaluate_elliptic(first: u32, dim: u32) -> Value {
    // The ray has no effect at α = 0.
    let z = zone(first, dim, 0.0);
    let slip = z.k * (z.mu * z.p - z.q);
    put_row(FORCE + first, -(z.k * z.mu * (z.p + z.mu * z.q)));
    for (var a = first + 1u; a < first + dim; a++) {
        put_row(FORCE + a, slip * scaled_residual(a, 0.0) * z.inverse * row(SHAPE + a));
    }
    return Value(0.5 * z.k * (z.p * z.p + z.q * z.q), z.piece, z.piece == 1u);
}

fn elliptic_along(first: u32, dim: u32, alpha: f32) -> Along {
    let before = zone(first, dim, 0.0);
    let z = zone(first, dim, alpha);
    let dn = z.mu * row(RAY + first);
    var along: f32 = 0.0;
    var squares: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        let du = row(SHAPE + a) * row(RAY + a);
        along += scaled_residual(a, alpha) * z.inverse * du;
        squares += du * du;
    }
    let da = dn - z.mu * along;
    let db = z.mu * dn + along;
    var second: f32 = 0.0;
    if (z.piece == 1u) {
        second = z.k * (da * da + z.c * (squares - along * along));
    } else if (z.piece == 2u) {
        second = z.k * (1.0 + z.mu * z.mu) * (dn * dn + squares);
    }
    let change = (z.p - before.p) * (z.p + before.p) + (z.q - before.q) * (z.q + before.q);
    return Along(z.k * (z.p * da + z.q * db), second, 0.5 * z.k * change);
}

// Writes column `i` of W J of a block.
fn weigh_elliptic(first: u32, dim: u32, i: u32) {
    let z = zone(first, dim, 0.0);
    if (z.piece != 1u) {
        for (var a = first; a < first + dim; a++) {
            let d = select(0.0, row(D + a), z.piece == 2u);
            put_row(WEIGHED + a * NV + i, d * row(JACOBIAN + a * NV + i));
        }
        return;
    }
    let normal = z.mu * row(JACOBIAN + first * NV + i);
    var along: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        along += scaled_residual(a, 0.0) * z.inverse * row(SHAPE + a) * row(JACOBIAN + a * NV + i);
    }
    // w·(F J), with w = (1, −μ u).
    let surface = normal - z.mu * along;
    put_row(WEIGHED + first * NV + i, z.k * z.mu * surface);
    for (var a = first + 1u; a < first + dim; a++) {
        let u = scaled_residual(a, 0.0) * z.inverse;
        let scaled = row(SHAPE + a) * row(JACOBIAN + a * NV + i);
        let entry = z.c * (scaled - u * along) - z.mu * u * surface;
        put_row(WEIGHED + a * NV + i, z.k * row(SHAPE + a) * entry);
    }
}
