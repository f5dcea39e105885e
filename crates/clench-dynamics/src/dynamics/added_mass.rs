//! The inertia of the medium that an ellipsoid moves (Tuckerman 1925, as MuJoCo's *Computation*, "Added mass").
//!
//! ```text
//! κ_i = ∫₀^∞ r_x r_y r_z / √((r_i² + λ)³ (r_j² + λ) (r_k² + λ)) dλ        mass_i = V κ_i / (2 − κ_i)
//! inertia_i = V/5 (r_j² − r_k²)² (κ_k − κ_j) / (2 (r_j² − r_k²) + (r_j² + r_k²) (κ_j − κ_k))
//! ```
//!
//! The quadrature is MuJoCo's, for equal results: Kronrod's rule of 15 points in x, where λ = s x³ / (1 − x)² and s =
//! (r_i³ r_j r_k)^(2/5).

use clench_math::Vec3;
use std::f64::consts::PI;

/// Kronrod's nodes on [0, 1] up to the middle, and their weights, with MuJoCo's eight digits.
const RULE: [(f64, f64); 8] = [
    (0.00427231, 0.01146766),
    (0.02544604, 0.03154605),
    (0.06756779, 0.05239501),
    (0.12923441, 0.07032663),
    (0.20695638, 0.08450236),
    (0.29707742, 0.09517529),
    (0.39610752, 0.10221647),
    (0.5, 0.10474107),
];

/// Minimum denominator (MuJoCo's `mjEPS`).
const LEAST: f64 = 1e-14;

/// Inertia of the medium, at unit density.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AddedMass {
    /// Along each axis, m³.
    pub mass: [f64; 3],
    /// About each axis, m⁵.
    pub inertia: [f64; 3],
}

impl AddedMass {
    /// Computes the added mass of an ellipsoid with these semi-axes.
    pub(crate) fn of_ellipsoid(r: Vec3<f64>) -> Self {
        let r = r.to_array();
        let volume = 4.0 / 3.0 * PI * r[0] * r[1] * r[2];
        let others = |i: usize| ((i + 1) % 3, (i + 2) % 3);
        let kappa: [f64; 3] = std::array::from_fn(|i| {
            let (j, k) = others(i);
            kappa(r[i], r[j], r[k])
        });
        let inertia = |i: usize| {
            let (j, k) = others(i);
            let (difference, sum) = (r[j] * r[j] - r[k] * r[k], r[j] * r[j] + r[k] * r[k]);
            let change = kappa[j] - kappa[k];
            let below = (2.0 * difference + sum * change).abs().max(LEAST);
            volume * difference * difference * change.abs() / (5.0 * below)
        };
        AddedMass {
            mass: kappa.map(|kappa| volume * kappa / (2.0 - kappa).max(LEAST)),
            inertia: std::array::from_fn(inertia),
        }
    }
}

/// Computes κ of the first of three semi-axes.
fn kappa(first: f64, second: f64, third: f64) -> f64 {
    let scale = (first * first * first * second * third).powf(0.4);
    let shrunk = |lambda: f64, axis: f64| 1.0 + lambda / (axis * axis);
    let integrand = |x: f64| {
        let rest = 1.0 - x;
        let lambda = scale * x * x * x / (rest * rest);
        let slope = x * x * (3.0 - x) / (rest * rest * rest);
        let own = shrunk(lambda, first);
        slope / (own * (own * shrunk(lambda, second) * shrunk(lambda, third)).sqrt())
    };
    let mut sum = 0.0;
    for (node, weight) in RULE {
        let mirrored = if node < 0.5 {
            integrand(1.0 - node)
        } else {
            0.0
        };
        sum += weight * (integrand(node) + mirrored);
    }
    sum * scale / (first * first)
}
