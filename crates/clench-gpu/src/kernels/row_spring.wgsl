// The spring and damper of a row over a step. CPU counterpart: `ImplicitRows` in `constraint/implicit.rs`.

// Returns 1 + h b + h² k d of row `a`.
fn beta(a: u32) -> f32 {
    return 1.0 + TIMESTEP * row(DAMPING + a) + TIMESTEP * TIMESTEP * row(STIFFNESS + a);
}

// Returns the change of a row's reference acceleration per change of its position, with the sign reversed.
fn slope_of_row(a: u32) -> f32 {
    if (IN_METRIC) {
        return row(STIFFNESS + a) / beta(a);
    }
    return row(STIFFNESS + a);
}
