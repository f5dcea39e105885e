// Frictional contact with the exact cone. CPU counterpart: `clench-solver/src/costs/elliptic.rs`, which derives the
// formulas.

// A block at y + α dy, in coordinates in which its cone is circular.
struct Zone {
    k: f32,
    mu: f32,
    // N − μT and μN + T, each if negative.
    p: f32,
    q: f32,
    slip: Slip,
    // μ² − μ N/T in the middle zone.
    c: f32,
    // 0 top, 1 middle, 2 bottom.
    piece: u32,
}

fn zone(first: u32, dim: u32, alpha: f32) -> Zone {
    let mu = row(SHAPE + first);
    let k = row(D + first) / (mu * mu * (1.0 + mu * mu) * stiffening(first));
    let n = mu * (row(RESIDUAL + first) + alpha * row(RAY + first));
    let slip = slip_of(first, dim, alpha);
    let above = n - mu * slip.t;
    let below = mu * n + slip.t;
    if (above >= 0.0) {
        return Zone(k, mu, 0.0, 0.0, slip, 0.0, 0u);
    }
    if (below <= 0.0) {
        return Zone(k, mu, above, below, slip, 0.0, 2u);
    }
    return Zone(k, mu, above, 0.0, slip, mu * mu - mu * n * slip.inverse, 1u);
}

fn evaluate_elliptic(first: u32, dim: u32) -> Value {
    // The ray has no effect at α = 0.
    let z = zone(first, dim, 0.0);
    let slip = z.k * (z.mu * z.p - z.q);
    put_row(FORCE + first, -(z.k * z.mu * (z.p + z.mu * z.q)));
    for (var a = first + 1u; a < first + dim; a++) {
        put_row(FORCE + a, slip * scaled_residual(a, 0.0) * z.slip.inverse * row(SHAPE + a));
    }
    return Value(0.5 * z.k * (z.p * z.p + z.q * z.q), z.piece, z.piece == 1u);
}

fn elliptic_along(first: u32, dim: u32, alpha: f32) -> Along {
    let before = zone(first, dim, 0.0);
    let after = zone(first, dim, alpha);
    let slip = slip_path(first, dim, alpha, before.slip, after.slip);
    let k = after.k;
    let mu = after.mu;
    let dn = mu * row(RAY + first);
    let dt = alpha * slip.along + slip.bend;
    let in_p = before.p < 0.0 && after.p < 0.0;
    let in_q = before.piece == 2u && after.piece == 2u;
    let dp = select(after.p - before.p, alpha * dn - mu * dt, in_p);
    let dq = select(after.q - before.q, mu * alpha * dn + dt, in_q);
    let end = slip.along + slip.turn;
    let growth = k * ((dp + mu * dq) * dn + (dq - mu * dp) * end + (before.q - mu * before.p) * slip.turn);
    var second: f32 = 0.0;
    if (after.piece == 1u) {
        let da = dn - mu * end;
        second = k * (da * da + after.c * (slip.squares - end * end));
    } else if (after.piece == 2u) {
        second = k * (1.0 + mu * mu) * (dn * dn + slip.squares);
    }
    // The distances of p and q from their tangents at the start.
    let p = select(dp - alpha * (dn - mu * slip.along), -(mu * slip.bend), in_p);
    let q = select(dq - alpha * (mu * dn + slip.along), slip.bend, in_q);
    return Along(growth, second, k * (0.5 * (dp * dp + dq * dq) + before.p * p + before.q * q));
}

// Writes column `i` of W J of a block.
fn weigh_elliptic(first: u32, dim: u32, i: u32) {
    let z = zone(first, dim, 0.0);
    if (z.piece != 1u) {
        for (var a = first; a < first + dim; a++) {
            let d = select(0.0, row(D + a) / stiffening(first), z.piece == 2u);
            put_row(WEIGHED + a * NV + i, d * row(JACOBIAN + a * NV + i));
        }
        return;
    }
    let normal = z.mu * row(JACOBIAN + first * NV + i);
    var along: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        along += scaled_residual(a, 0.0) * z.slip.inverse * row(SHAPE + a) * row(JACOBIAN + a * NV + i);
    }
    // w·(F J), with w = (1, −μ u).
    let surface = normal - z.mu * along;
    put_row(WEIGHED + first * NV + i, z.k * z.mu * surface);
    for (var a = first + 1u; a < first + dim; a++) {
        let u = scaled_residual(a, 0.0) * z.slip.inverse;
        let scaled = row(SHAPE + a) * row(JACOBIAN + a * NV + i);
        let entry = z.c * (scaled - u * along) - z.mu * u * surface;
        put_row(WEIGHED + a * NV + i, z.k * row(SHAPE + a) * entry);
    }
}
