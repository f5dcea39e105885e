// Limits and frictionless contacts. CPU counterpart: `clench-solver/src/costs/one_sided.rs`, which derives the formulas.

fn evaluate_edge(a: u32) -> Value {
    let m = min(row(RESIDUAL + a), 0.0);
    let d = row(D + a);
    put_row(FORCE + a, -(d * m));
    return Value(0.5 * d * m * m, select(0u, 1u, m < 0.0), false);
}

// Returns the change of min(y, 0) when y changes by `step`. If both ends are violated, it is the step itself, without
// cancellation.
fn violation_change(y: f32, step: f32) -> f32 {
    let end = y + step;
    return select(min(end, 0.0) - min(y, 0.0), step, y < 0.0 && end < 0.0);
}

// Returns a one-sided term of stiffness `d` that starts at `y` and moves by α times `dy`.
fn edge_along(d: f32, y: f32, dy: f32, alpha: f32) -> Along {
    let step = alpha * dy;
    let change = violation_change(y, step);
    let stiff = select(0.0, d, y + step < 0.0);
    let divergence = d * (0.5 * change * change + min(y, 0.0) * (change - step));
    return Along(d * dy * change, stiff * dy * dy, divergence);
}
