// Evaluation of blocks by their cost: value, force, active set, and the terms of a line search. CPU counterparts:
// `clench-solver/src/costs`.

// A cost along the ray, at α: the growth of its slope since 0, its second derivative, and its height above its tangent
// at 0. Opposing forces cancel in a slope; growths and heights are sums of terms of one sign.
struct Along {
    growth: f32,
    second: f32,
    divergence: f32,
}

fn join_along(a: Along, b: Along) -> Along {
    return Along(a.growth + b.growth, a.second + b.second, a.divergence + b.divergence);
}

// Returns the terms of a block; zero for quadratic costs, whose curvature is constant.
fn block_along(b: u32, alpha: f32) -> Along {
    let first = block(b, BLOCK_ROW);
    let cost = block(b, BLOCK_COST);
    if (ELLIPTIC_CONES && cost == COST_ELLIPTIC) {
        return elliptic_along(first, block(b, BLOCK_DIM), alpha);
    }
    if (COULOMB_CONTACTS && cost == COST_COULOMB) {
        return coulomb_along(first, block(b, BLOCK_DIM), alpha);
    }
    switch cost {
        case COST_QUADRATIC: {
            return Along(0.0, 0.0, 0.0);
        }
        case COST_HUBER: {
            return huber_along(first, alpha);
        }
        case COST_PYRAMID: {
            return pyramid_along(first, block(b, BLOCK_DIM), alpha);
        }
        case COST_ONE_SIDED, default: {
            return edge_along(row(D + first), row(RESIDUAL + first), row(RAY + first), alpha);
        }
    }
}

// The result of an evaluation: the cost, the active set, and whether the block is on a curved piece.
struct Value {
    cost: f32,
    active_set: u32,
    curved: bool,
}

fn evaluate_block(b: u32) -> Value {
    let first = block(b, BLOCK_ROW);
    let cost = block(b, BLOCK_COST);
    if (ELLIPTIC_CONES && cost == COST_ELLIPTIC) {
        return evaluate_elliptic(first, block(b, BLOCK_DIM));
    }
    if (COULOMB_CONTACTS && cost == COST_COULOMB) {
        return evaluate_coulomb(first, block(b, BLOCK_DIM));
    }
    switch cost {
        case COST_QUADRATIC: {
            return evaluate_quadratic(first, block(b, BLOCK_DIM));
        }
        case COST_HUBER: {
            return evaluate_huber(first);
        }
        case COST_PYRAMID: {
            return evaluate_pyramid(first, block(b, BLOCK_DIM));
        }
        case COST_ONE_SIDED, default: {
            return evaluate_edge(first);
        }
    }
}
