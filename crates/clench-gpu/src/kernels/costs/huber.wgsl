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

fn huber_along(a: u32, alpha: f32) -> Along {
    let d = row(D + a);
    let dy = row(RAY + a);
    let y = row(RESIDUAL + a);
    let limit = row(R + a) * row(SHAPE + a);
    let step = alpha * dy;
    let end = y + step;
    let c0 = clamp(y, -limit, limit);
    let c1 = clamp(end, -limit, limit);
    let ends_inside = abs(end) < limit;
    // Within the quadratic piece both follow from the step, without cancellation.
    let inside = abs(y) < limit && ends_inside;
    let change = select(c1 - c0, step, inside);
    let beyond = select(end - 0.5 * (c0 + c1), 0.5 * step, inside);
    return Along(d * change * dy, select(0.0, d, ends_inside) * dy * dy, d * change * beyond);
}
