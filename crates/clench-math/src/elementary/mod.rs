//! Elementary functions, written once for every [`Real`]: branch-free in `T`, without fused multiply-add and without
//! tables, so that lanes equal scalars to the bit on every processor.
//!
//! Each function reduces its argument to a small interval, evaluates a polynomial there and puts the pieces back
//! together, carrying rounding errors along where they would show. Polynomials are minimax (Remez exchange in 60
//! digits), coefficients lowest order first, one set for `f64` and a shorter one for `f32`.
//!
//! Largest errors found, in units in the last place (`f64`: 2 × 10⁷ random arguments against 48-digit values;
//! `f32`: every argument of sine and cosine up to 10⁵, 4 × 10⁷ pairs of atan2, 3 × 10⁶ of the rest):
//!
//! |       | sin  | cos  | atan2 | exp  | ln   | powf |
//! | ----- | ---- | ---- | ----- | ---- | ---- | ---- |
//! | `f64` | 0.78 | 0.80 | 1.48  | 0.91 | 0.51 | 0.95 |
//! | `f32` | 0.86 | 0.86 | 1.49  | 0.94 | 0.51 | 0.95 |

mod exponential;
mod extended;
mod trigonometric;

pub(crate) use exponential::{exp, ln, powf};
pub(crate) use trigonometric::{atan2, sin_cos};

use crate::{Real, Scalar};

/// A constant that depends on the lane's precision.
#[inline(always)]
fn by_precision<T: Real, C>(double: C, single: C) -> C {
    if T::Scalar::DIGITS > f32::MANTISSA_DIGITS {
        double
    } else {
        single
    }
}

/// Σ cᵢ zⁱ, even and odd powers apart so that the two chains overlap.
#[inline(always)]
fn polynomial<T: Real>(z: T, double: &[f64], single: &[f64]) -> T {
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
fn nearest_integer<T: Real>(x: T) -> T {
    // 1.5 × 2⁵² pushes the fraction bits out of the mantissa, rounding to even on the way.
    let shift = T::new(by_precision::<T, _>(6_755_399_441_055_744.0, 12_582_912.0));
    (x + shift) - shift
}

/// `x` held between two bounds; NaN stays NaN.
#[inline(always)]
fn bounded<T: Real>(x: T, low: f64, high: f64) -> T {
    T::new(high).min(T::new(low).max(x))
}
