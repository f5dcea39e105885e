//! Polynomials, and small steps shared by all functions.

use crate::{Real, Scalar};

/// Selects a constant by the lane's precision.
#[inline(always)]
pub(super) fn by_precision<T: Real, C>(double: C, single: C) -> C {
    if T::Scalar::IS_SINGLE { single } else { double }
}

/// Computes Σ cᵢ zⁱ, with even and odd powers separate so that the two dependency chains overlap.
#[inline(always)]
pub(super) fn polynomial<T: Real>(z: T, double: &[f64], single: &[f64]) -> T {
    let coefficients = by_precision::<T, _>(double, single);
    let squared = z * z;
    every_other(squared, coefficients) + z * every_other(squared, &coefficients[1..])
}

/// Computes c₀ + c₂ x + c₄ x² + …
#[inline(always)]
fn every_other<T: Real>(x: T, coefficients: &[f64]) -> T {
    let last = (coefficients.len() - 1) / 2;
    let mut sum = T::new(coefficients[2 * last]);
    for i in (0..last).rev() {
        sum = sum * x + T::new(coefficients[2 * i]);
    }
    sum
}

/// Computes the nearest integer, for magnitudes below a quarter of the first number without fraction bits (2⁵¹, 2²²).
#[inline(always)]
pub(super) fn nearest_integer<T: Real>(x: T) -> T {
    // Adding 1.5 × 2⁵² shifts the fraction bits out of the mantissa, rounding to even.
    let shift = T::new(by_precision::<T, _>(6_755_399_441_055_744.0, 12_582_912.0));
    (x + shift) - shift
}

/// Clamps `x` between two limits; NaN stays NaN.
#[inline(always)]
pub(super) fn clamp_keeping_nan<T: Real>(x: T, low: f64, high: f64) -> T {
    T::new(high).min(T::new(low).max(x))
}
