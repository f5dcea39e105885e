//! Exponential, logarithm and real powers.

use super::extended::{ordered_sum, two_product, two_sum};
use super::polynomial::{by_precision, clamp_keeping_nan, nearest_integer, polynomial};
use crate::{Real, Scalar, kernel};
use std::f64::consts::LOG2_E;

/// (eʳ − 1 − r) / r² for |r| ≤ ½ ln 2.
const EXPONENTIAL_64: [f64; 10] = [
    0.5000000000000012,
    0.166666666666667,
    0.04166666666651553,
    0.008333333333307238,
    0.001388888894698388,
    0.00019841269917314874,
    2.480148997826072e-05,
    2.7557216358932284e-06,
    2.7631266561974415e-07,
    2.5117843735792646e-08,
];
const EXPONENTIAL_32: [f64; 5] = [
    0.5000000095105379,
    0.1666651889907348,
    0.04166620607059592,
    0.00836888232010811,
    0.0013950473435491416,
];
/// (2 artanh s − 2s − ⅔ s³) / s⁵ as a polynomial in s² for |s| ≤ (√2 − 1)/(√2 + 1).
const LOGARITHM_64: [f64; 8] = [
    0.3999999999999998,
    0.285714285714451,
    0.22222222217539195,
    0.18181818869979532,
    0.153845568938563,
    0.1333631653996441,
    0.11674836346811365,
    0.11988864589335137,
];
const LOGARITHM_32: [f64; 3] = [0.40000152179355647, 0.28547133361409, 0.23418582781918454];

/// Returns ln 2 in two parts, the first short enough to be multiplied exactly by any exponent.
#[inline(always)]
fn ln_2<T: Real>() -> (T, T) {
    let high = by_precision::<T, _>(0.6931471805598903, 0.693145751953125);
    let low = by_precision::<T, _>(5.497923018708371e-14, 1.428606765330187e-06);
    (T::new(high), T::new(low))
}

/// Computes the exponential: 0 or ∞ past the ends of the range, with gradual underflow.
#[kernel]
pub(crate) fn exp<T: Real>(x: T) -> T {
    exp_extended(x, T::ZERO)
}

/// Computes the natural logarithm: −∞ at 0, NaN below.
#[kernel]
pub(crate) fn ln<T: Real>(x: T) -> T {
    let infinity = T::splat(T::Scalar::INFINITY);
    let (high, low) = ln_extended(x);
    let y = T::select(x.eq(infinity), infinity, high + low);
    let y = T::select(x.eq(T::ZERO), -infinity, y);
    T::select(x.ge(T::ZERO), y, T::new(f64::NAN))
}

/// Computes `x` to the power `p`, for x ≥ 0 (NaN below): exp(p ln x) in extended precision. Anything to the power 0 is
/// 1.
#[kernel]
pub(crate) fn powf<T: Real>(x: T, p: T) -> T {
    let (zero, infinity) = (T::ZERO, T::splat(T::Scalar::INFINITY));
    // A larger power overflows or underflows for every x but 1, and could make the product below inexact.
    let limit = by_precision::<T, _>(f64::powi(2.0, 64), f64::powi(2.0, 32));
    let clamped_p = clamp_keeping_nan(p, -limit, limit);
    let (high, low) = ln_extended(x);
    let (product, error) = two_product(high, clamped_p);
    let y = exp_extended(product, error + low * clamped_p);

    let falls = p.lt(zero);
    let y = T::select(x.eq(zero), T::select(falls, infinity, zero), y);
    let y = T::select(x.eq(infinity), T::select(falls, zero, infinity), y);
    let y = T::select(x.ge(zero) & p.eq(p), y, T::new(f64::NAN));
    T::select(p.eq(zero), T::ONE, y)
}

/// Computes e to the power `high + low`, with `low` far below `high`.
///
/// x = k ln 2 + r with |r| ≤ ½ ln 2, and eˣ = 2ᵏ eʳ.
#[inline(always)]
fn exp_extended<T: Real>(high: T, low: T) -> T {
    // A little past the points at which the result is ∞ or 0. At these limits the low part no longer affects the
    // result, but must stay small.
    let (least, limit) = by_precision::<T, _>((-750.0, 712.0), (-108.0, 92.0));
    let high = clamp_keeping_nan(high, least, limit);
    let low = clamp_keeping_nan(low, -1.0, 1.0);
    let exponent = nearest_integer(high * T::new(LOG2_E));
    let (ln2_high, ln2_low) = ln_2::<T>();
    let (r, tail) = ordered_sum(high - exponent * ln2_high, low - exponent * ln2_low);
    let power = T::ONE + (r + (tail + r * r * polynomial(r, &EXPONENTIAL_64, &EXPONENTIAL_32)));
    // In two halves, since 2ᵏ itself may be out of range; only the second product can round.
    let half = nearest_integer(exponent * T::new(0.5));
    power * half.exp2_integer() * (exponent - half).exp2_integer()
}

/// Computes the natural logarithm of a positive finite number as an unevaluated sum, accurate to about 10 bits beyond
/// the precision.
///
/// x = 2ᵏ m with m in [√½, √2), and ln m = 2 artanh s with s = (m − 1)/(m + 1).
#[inline(always)]
fn ln_extended<T: Real>(x: T) -> (T, T) {
    let (one, two) = (T::ONE, T::new(2.0));
    let (exponent, m) = split_any(x);

    let numerator = m - one;
    let (denominator, denominator_low) = two_sum(m, one);
    let s = numerator / denominator;
    let (product, error) = two_product(s, denominator);
    let remainder = ((numerator - product) - error) - s * denominator_low;
    let s_low = remainder / denominator;

    // ln m = s (2 + z (⅔ + z Q(z))) with z = s².
    let (z, z_error) = two_product(s, s);
    let z_low = z_error + two * s * s_low;
    let two_thirds = T::new(2.0 / 3.0);
    // The rounding error of ⅔.
    let two_thirds_low = T::new(by_precision::<T, _>(
        3.700743415417188e-17,
        -1.9868215517249155e-08,
    ));
    let (inner, inner_low) =
        ordered_sum(two_thirds, z * polynomial(z, &LOGARITHM_64, &LOGARITHM_32));
    let (cubic, cubic_error) = two_product(z, inner);
    let cubic_low = cubic_error + z * (inner_low + two_thirds_low) + z_low * inner;
    let (factor, factor_error) = ordered_sum(two, cubic);
    let (ln_m, ln_m_error) = two_product(s, factor);
    let ln_m_low = ln_m_error + s * (factor_error + cubic_low) + s_low * factor;

    let (ln2_high, ln2_low) = ln_2::<T>();
    let (sum, sum_error) = two_sum(exponent * ln2_high, ln_m);
    ordered_sum(sum, sum_error + (ln_m_low + exponent * ln2_low))
}

/// Computes [`Real::split_exponent`], extended to subnormal numbers.
#[inline(always)]
fn split_any<T: Real>(x: T) -> (T, T) {
    let (digits, scale) =
        by_precision::<T, _>((53.0, f64::powi(2.0, 53)), (24.0, f64::powi(2.0, 24)));
    let subnormal = x.lt(T::splat(T::Scalar::MIN_POSITIVE));
    let scale = T::select(subnormal, T::new(scale), T::ONE);
    let (exponent, m) = (x * scale).split_exponent();
    let shift = T::select(subnormal, T::new(digits), T::ZERO);
    (exponent - shift, m)
}
