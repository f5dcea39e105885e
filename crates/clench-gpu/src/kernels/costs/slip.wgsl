// The slip of a contact: its tangential rows, scaled so that the limit of friction becomes circular. CPU counterpart:
// `clench-solver/src/costs/slip.rs`, which explains it.

// The slip at y + α dy.
struct Slip {
    // T.
    t: f32,
    // 1 / T, which is 0 without slip.
    inverse: f32,
}

fn scaled_residual(a: u32, alpha: f32) -> f32 {
    return row(SHAPE + a) * (row(RESIDUAL + a) + alpha * row(RAY + a));
}

fn slip_of(first: u32, dim: u32, alpha: f32) -> Slip {
    var t2: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        let u = scaled_residual(a, alpha);
        t2 += u * u;
    }
    let t = sqrt(t2);
    return Slip(t, select(0.0, 1.0 / max(t, SMALLEST), t > 0.0));
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
fn slip_path(first: u32, dim: u32, alpha: f32, before: Slip, after: Slip) -> SlipPath {
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
