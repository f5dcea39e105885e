//! Polynomials, and the small steps that all functions share.

use crate::{Real, Scalar};

/// A constant that depends on the lane's precision.
#[inline(always)]
pub(super) fn by_precision<T: Real, C>(double: C, single: C) -> C {
    if T::Scalar::DIGITS > f32::MANTISSA_DIGITS {
        double
    } else {
        single
    }
}

/// Σ cᵢ zⁱ, even and odd powers apart so that the two chains overlap.
#[inline(always)]
pub(super) fn polynomial<T: Real>(z: T, double: &[f64], single: &[f64]) -> T {
    let coefficients = by_precision::<T, _>(double, single);
    let squared = z * z;
    every_other(squared, coefficients) + z * every_other(squared, &coefficients[1..])
}

/// c₀ + c₂ x + c₄ x² + …
#[inline(always)]
fn every_other<T: Real>(x: T, coefficients: &[f64]) -> T {
    let last = (coefficients.len() - 1) / 2;
    let mut sum = T::new(coefficients[2 * last]);
    for i in (0..last).rev() {
        sum = sum * x + T::new(coefficients[2 * i]);
    }
    sum
}

/// The nearest integer, for magnitudes below a quarter of the first number without fraction bits (2⁵¹, 2²²).
#[inline(always)]
pub(super) fn nearest_integer<T: Real>(x: T) -> T {
    // 1.5 × 2⁵² pushes the fraction bits out of the mantissa, rounding to even on the way.
    let shift = T::new(by_precision::<T, _>(6_755_399_441_055_744.0, 12_582_912.0));
    (x + shift) - shift
}

/// `x` held between two bounds; NaN stays NaN.
#[inline(always)]
pub(super) fn bounded<T: Real>(x: T, low: f64, high: f64) -> T {
    T::new(high).min(T::new(low).max(x))
}
