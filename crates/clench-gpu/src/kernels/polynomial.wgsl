// Polynomial springs and dampers. CPU counterpart: `dynamics/polynomial.rs`.

// Returns a + b x + c x², minus a spring's force over its displacement x.
fn stiffness(coefficients: vec3f, x: f32) -> f32 {
    return coefficients.x + x * (coefficients.y + x * coefficients.z);
}

// Returns a + 2 b x + 3 c x², minus the derivative of that force.
fn stiffness_slope(coefficients: vec3f, x: f32) -> f32 {
    return coefficients.x + x * (2.0 * coefficients.y + x * (3.0 * coefficients.z));
}

// Returns minus the derivative of the force of a damper, with its coefficients at `law`, by its velocity.
fn damping_slope(law: u32, velocity: f32) -> f32 {
    return stiffness_slope(parameter3(law), abs(velocity));
}
