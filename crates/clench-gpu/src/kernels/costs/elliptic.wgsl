// Frictional contact with the exact cone. CPU counterparts: `clench-solver/src/costs/elliptic.rs`, which derives the
// formulas, and `slip.rs`.

// A block at y + α dy, in coordinates in which its cone is circular.
struct Zone {
    k: f32,
    mu: f32,
    // N − μT and μN + T, each if negative.
    p: f32,
    q: f32,
    // T, and 1 / T, which is 0 without slip.
    t: f32,
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
    let k = row(D + first) / (mu * mu * (1.0 + mu * mu) * stiffening(first));
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
        return Zone(k, mu, 0.0, 0.0, t, inverse, 0.0, 0u);
    }
    if (below <= 0.0) {
        return Zone(k, mu, above, below, t, inverse, 0.0, 2u);
    }
    return Zone(k, mu, above, 0.0, t, inverse, mu * mu - mu * n * inverse, 1u);
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

// The slip along the ray, from y to y + α dy.
struct SlipPath {
    // |U'|².
    squares: f32,
    // u₀·U'.
    along: f32,
    // The growth of u·U'.
    turn: f32,
    // T₁ − T₀ − α u₀·U' ≥ 0.
    bend: f32,
}

// Computes the differences in a form that avoids cancellation for small steps.
fn slip_path(first: u32, dim: u32, alpha: f32, before: Zone, after: Zone) -> SlipPath {
    var along: f32 = 0.0;
    var squares: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        let du = row(SHAPE + a) * row(RAY + a);
        along += scaled_residual(a, 0.0) * before.inverse * du;
        squares += du * du;
    }
    // T₁² = (T₀ + α u₀·U')² + α² (|U'|² − (u₀·U')²). The bend is the height of T₁ above its tangent T₀ + α u₀·U'.
    let across = max(squares - along * along, 0.0);
    let straight = before.t + alpha * along;
    let ahead = straight > 0.0;
    let sum = select(1.0, after.t + straight, ahead);
    let bend = select(after.t - straight, alpha * alpha * across / sum, ahead);
    let slips = after.t > 0.0;
    let turn = (alpha * across - along * bend) / select(1.0, after.t, slips);
    return SlipPath(squares, along, select(-along, turn, slips), bend);
}

fn elliptic_along(first: u32, dim: u32, alpha: f32) -> Along {
    let before = zone(first, dim, 0.0);
    let after = zone(first, dim, alpha);
    let slip = slip_path(first, dim, alpha, before, after);
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
