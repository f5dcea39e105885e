// Frictional contact with a linearized cone. CPU counterpart: `clench-solver/src/costs/pyramid.rs`, which derives the
// formulas. The active set has two bits for each friction row.

fn evaluate_pyramid(first: u32, dim: u32) -> Value {
    let d = row(D + first);
    let y = row(RESIDUAL + first);
    var normal: f32 = 0.0;
    var squares: f32 = 0.0;
    var active_set = 0u;
    for (var k = 1u; k < dim; k++) {
        let mu = row(SHAPE + first + k);
        let side = mu * row(RESIDUAL + first + k);
        let plus = min(y + side, 0.0);
        let minus = min(y - side, 0.0);
        normal += plus + minus;
        squares += plus * plus + minus * minus;
        put_row(FORCE + first + k, -(d * mu * (plus - minus)));
        active_set |= select(0u, 1u, plus < 0.0) << (2u * k - 2u);
        active_set |= select(0u, 1u, minus < 0.0) << (2u * k - 1u);
    }
    put_row(FORCE + first, -(d * normal));
    return Value(0.5 * d * squares, active_set, false);
}

fn pyramid_along(first: u32, dim: u32, alpha: f32) -> Along {
    let d = row(D + first);
    let y = row(RESIDUAL + first);
    let dy = row(RAY + first);
    var sum = Along(0.0, 0.0, 0.0);
    for (var a = first + 1u; a < first + dim; a++) {
        let side = row(SHAPE + a) * row(RESIDUAL + a);
        let dside = row(SHAPE + a) * row(RAY + a);
        sum = join_along(sum, edge_along(d, y + side, dy + dside, alpha));
        sum = join_along(sum, edge_along(d, y - side, dy - dside, alpha));
    }
    return sum;
}

// Writes column `i` of W J of a block.
fn weigh_pyramid(b: u32, first: u32, dim: u32, i: u32) {
    let active_set = u32(row(ACTIVE_SET + b));
    let d = row(D + first);
    let normal = row(JACOBIAN + first * NV + i);
    var sum = d * f32(countOneBits(active_set)) * normal;
    for (var k = 1u; k < dim; k++) {
        let a = first + k;
        let plus = f32((active_set >> (2u * k - 2u)) & 1u);
        let minus = f32((active_set >> (2u * k - 1u)) & 1u);
        let mu = row(SHAPE + a);
        let mixed = d * mu * (plus - minus);
        let j = row(JACOBIAN + a * NV + i);
        sum += mixed * j;
        put_row(WEIGHED + a * NV + i, mixed * normal + d * mu * mu * (plus + minus) * j);
    }
    put_row(WEIGHED + first * NV + i, sum);
}
