// Dry friction. CPU counterpart: `clench-solver/src/costs/huber.rs`, which derives the formulas.

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

// The change of one row from y₀ to y₁.
struct RowMove {
    // c₁ − c₀, with c = y clamped to the limits.
    change: f32,
    // y₁ − ½ (c₀ + c₁), with the sign of the change.
    beyond: f32,
    ends_inside: bool,
}

fn move_row(limit: f32, y: f32, step: f32) -> RowMove {
    let end = y + step;
    let c0 = clamp(y, -limit, limit);
    let c1 = clamp(end, -limit, limit);
    let ends_inside = abs(end) < limit;
    // Within the quadratic piece both follow from the step, without cancellation.
    let inside = abs(y) < limit && ends_inside;
    return RowMove(select(c1 - c0, step, inside), select(end - 0.5 * (c0 + c1), 0.5 * step, inside), ends_inside);
}

fn huber_along(a: u32, alpha: f32) -> Along {
    let d = row(D + a);
    let dy = row(RAY + a);
    let moved = move_row(row(R + a) * row(SHAPE + a), row(RESIDUAL + a), alpha * dy);
    return Along(d * moved.change * dy, select(0.0, d, moved.ends_inside) * dy * dy, d * moved.change * moved.beyond);
}
