// W J of the rows on pieces with curvature, for the Hessian M + Jᵀ W J.

fn weigh_edge(a: u32, i: u32, weight: f32) {
    put_row(WEIGHED + a * NV + i, weight * row(JACOBIAN + a * NV + i));
}

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

// Writes column `i` of W J of block `b`.
fn weigh(b: u32, i: u32) {
    let first = block(b, BLOCK_ROW);
    let kind = block(b, BLOCK_KIND);
    if (ELLIPTIC_CONES && kind == CONTACT_ELLIPTIC) {
        weigh_elliptic(first, block(b, BLOCK_DIM), i);
        return;
    }
    switch kind {
        case CONTACT_PYRAMID: {
            weigh_pyramid(b, first, block(b, BLOCK_DIM), i);
        }
        // Piece 1 has curvature in quadratic costs, dry friction and one-sided costs.
        case HELD, COUPLING, DRY_FRICTION, LIMIT, CONTACT_NORMAL, default: {
            let stiff = row(ACTIVE_SET + b) == 1.0;
            for (var a = first; a < first + block(b, BLOCK_DIM); a++) {
                weigh_edge(a, i, select(0.0, row(D + a), stiff));
            }
        }
    }
}

// Returns true if a block is on a piece with curvature.
fn is_stiff(b: u32) -> bool {
    let active_set = row(ACTIVE_SET + b);
    if (block(b, BLOCK_KIND) == DRY_FRICTION) {
        return active_set == 1.0;
    }
    return active_set != 0.0;
}

// Lists the stiff rows, in order, and weighs them; returns their number.
fn weigh_rows(nblock: u32) -> u32 {
    var count = 0u;
    for (var start = 0u; start < nblock; start += GROUP) {
        let b = start + lane;
        var dim = 0u;
        if (b < nblock && is_stiff(b)) {
            dim = block(b, BLOCK_DIM);
        }
        let sums = sums_up_to(vec4f(f32(dim), 0.0, 0.0, 0.0));
        let place = count + u32(sums.before.x);
        count += u32(sums.all.x);
        for (var a = 0u; a < dim; a++) {
            put_row(STIFF + place + a, f32(block(b, BLOCK_ROW) + a));
        }
    }
    for (var k = lane; k < nblock * NV; k += GROUP) {
        if (is_stiff(k / NV)) {
            weigh(k / NV, k % NV);
        }
    }
    join();
    return count;
}
