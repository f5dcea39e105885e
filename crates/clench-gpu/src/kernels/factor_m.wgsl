// The factor of the mass matrix M. CPU counterpart: `clench-solver/src/tree/factor.rs`. `factor_h.wgsl` factors the
// Hessian H.

// Returns zero: nothing is added to the diagonal of M.
fn added_inertia(i: u32) -> f32 {
    return 0.0;
}

// Factors M into QLD; returns false if this thread found a pivot that is not positive.
fn factor_mass() -> bool {
    if (LONG_PATHS) {
        return !is_first() || articulated_factor();
    }
    copy_mass_to_factor();
    join();
    return factor_tree();
}
