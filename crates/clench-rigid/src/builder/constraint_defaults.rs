//! MuJoCo's defaults of how soft constraints are.

/// MuJoCo's default reference dynamics: time constant 0.02 s, damping ratio 1.
pub const DEFAULT_SOLREF: [f64; 2] = [0.02, 1.0];

/// MuJoCo's default impedance.
pub const DEFAULT_SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];
