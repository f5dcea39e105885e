// Equalities. CPU counterpart: `clench-solver/src/costs/quadratic.rs`. Their curvature along a ray is constant.

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

// Returns the second derivative along the ray.
fn quadratic_curvature(first: u32, dim: u32) -> f32 {
    var second: f32 = 0.0;
    for (var a = first; a < first + dim; a++) {
        let dy = row(RAY + a);
        second += row(D + a) * dy * dy;
    }
    return second;
}
