// The costs of blocks: value, force, active set, and the terms of a line search. CPU counterparts:
// `clench-solver/src/costs`.

// Derivatives of the cost along the ray, and its change from the start.
struct Along {
    first: f32,
    second: f32,
    change: f32,
}

fn join_along(a: Along, b: Along) -> Along {
    return Along(a.first + b.first, a.second + b.second, a.change + b.change);
}

// Computes a one-sided term of stiffness `d` at `y`, with rate `dy`, at α.
fn edge_along(d: f32, y: f32, dy: f32, alpha: f32) -> Along {
    let step = alpha * dy;
    let moved = y + step;
    let before = min(y, 0.0);
    let after = min(moved, 0.0);
    // If both are violated, the difference is the step itself, which keeps all digits.
    let difference = select(after - before, step, y < 0.0 && moved < 0.0);
    let stiff = select(0.0, d * dy, moved < 0.0);
    return Along(stiff * moved, stiff * dy, 0.5 * d * difference * (after + before));
}

fn huber_along(a: u32, alpha: f32) -> Along {
    let d = row(D + a);
    let y = row(RESIDUAL + a);
    let dy = row(RAY + a);
    let bound = row(R + a) * row(SHAPE + a);
    let step = alpha * dy;
    let moved = y + step;
    let c0 = clamp(y, -bound, bound);
    let c1 = clamp(moved, -bound, bound);
    let inside = abs(moved) < bound;
    let dc = select(c1 - c0, step, inside && abs(y) < bound);
    let change = d * (c0 * step + dc * (moved - 0.5 * (c0 + c1)));
    return Along(d * c1 * dy, select(0.0, d * dy * dy, inside), change);
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

// Computes an equality: a quadratic in each row.
fn quadratic_along(first: u32, dim: u32, alpha: f32) -> Along {
    var sum = Along(0.0, 0.0, 0.0);
    for (var a = first; a < first + dim; a++) {
        let d = row(D + a);
        let y = row(RESIDUAL + a);
        let dy = row(RAY + a);
        let step = alpha * dy;
        sum = join_along(sum, Along(d * dy * (y + step), d * dy * dy, d * step * (y + 0.5 * step)));
    }
    return sum;
}

fn block_along(b: u32, alpha: f32) -> Along {
    let first = block(b, BLOCK_ROW);
    let kind = block(b, BLOCK_KIND);
    if (ELLIPTIC_CONES && kind == CONTACT_ELLIPTIC) {
        return elliptic_along(first, block(b, BLOCK_DIM), alpha);
    }
    switch kind {
        case HELD, COUPLING: {
            return quadratic_along(first, block(b, BLOCK_DIM), alpha);
        }
        case DRY_FRICTION: {
            return huber_along(first, alpha);
        }
        case CONTACT_PYRAMID: {
            return pyramid_along(first, block(b, BLOCK_DIM), alpha);
        }
        case LIMIT, CONTACT_NORMAL, default: {
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

fn evaluate_edge(a: u32) -> Value {
    let m = min(row(RESIDUAL + a), 0.0);
    let d = row(D + a);
    put_row(FORCE + a, -(d * m));
    return Value(0.5 * d * m * m, select(0u, 1u, m < 0.0), false);
}

fn evaluate_huber(a: u32) -> Value {
    let y = row(RESIDUAL + a);
    let d = row(D + a);
    let r = row(R + a);
    let loss = row(SHAPE + a);
    if (abs(y) < r * loss) {
        put_row(FORCE + a, -(d * y));
        return Value(0.5 * d * y * y, 1u, false);
    }
    put_row(FORCE + a, select(-loss, loss, y < 0.0));
    return Value(loss * (abs(y) - 0.5 * r * loss), select(2u, 3u, y < 0.0), false);
}

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

fn evaluate_quadratic(first: u32, dim: u32) -> Value {
    var cost: f32 = 0.0;
    for (var a = first; a < first + dim; a++) {
        let y = row(RESIDUAL + a);
        let d = row(D + a);
        put_row(FORCE + a, -(d * y));
        cost += 0.5 * d * y * y;
    }
    return Value(cost, 1u, false);
}

fn evaluate_block(b: u32) -> Value {
    let first = block(b, BLOCK_ROW);
    let kind = block(b, BLOCK_KIND);
    if (ELLIPTIC_CONES && kind == CONTACT_ELLIPTIC) {
        return evaluate_elliptic(first, block(b, BLOCK_DIM));
    }
    switch kind {
        case HELD, COUPLING: {
            return evaluate_quadratic(first, block(b, BLOCK_DIM));
        }
        case DRY_FRICTION: {
            return evaluate_huber(first);
        }
        case CONTACT_PYRAMID: {
            return evaluate_pyramid(first, block(b, BLOCK_DIM));
        }
        case LIMIT, CONTACT_NORMAL, default: {
            return evaluate_edge(first);
        }
    }
}
