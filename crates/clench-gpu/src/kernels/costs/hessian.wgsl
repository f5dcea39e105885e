// W J of the rows on pieces with curvature, for the Hessian M + Jᵀ W J.

fn weigh_edge(a: u32, i: u32, weight: f32) {
    put_row(WEIGHED + a * NV + i, weight * row(JACOBIAN + a * NV + i));
}

// Writes column `i` of W J of block `b`.
fn weigh(b: u32, i: u32) {
    let first = block(b, BLOCK_ROW);
    let cost = block(b, BLOCK_COST);
    if (ELLIPTIC_CONES && cost == COST_ELLIPTIC) {
        weigh_elliptic(first, block(b, BLOCK_DIM), i);
        return;
    }
    if (COULOMB_CONTACTS && cost == COST_COULOMB) {
        weigh_coulomb(b, first, block(b, BLOCK_DIM), i);
        return;
    }
    switch cost {
        case COST_PYRAMID: {
            weigh_pyramid(b, first, block(b, BLOCK_DIM), i);
        }
        // Piece 1 has curvature in these costs.
        case COST_QUADRATIC, COST_HUBER, COST_ONE_SIDED, default: {
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
    let cost = block(b, BLOCK_COST);
    if (COULOMB_CONTACTS && cost == COST_COULOMB) {
        return is_stiff_coulomb(b);
    }
    if (cost == COST_HUBER) {
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
        let offset = count + u32(sums.before.x);
        count += u32(sums.all.x);
        for (var a = 0u; a < dim; a++) {
            put_row(STIFF + offset + a, f32(block(b, BLOCK_ROW) + a));
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
