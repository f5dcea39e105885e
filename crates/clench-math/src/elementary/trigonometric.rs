//! Sine, cosine and the angle of a point.

use super::extended::{ordered_sum, two_sum};
use super::polynomial::{by_precision, nearest_integer, polynomial};
use crate::{Real, Scalar, kernel};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_4, SQRT_2};

/// π/2 in parts short enough that their products with the number of quarter turns are exact, up to 2²⁰ quarter turns
/// in `f64` and 2¹⁶ in `f32` (1.6 million and 100,000 rad).
struct QuarterTurn {
    /// Parts whose subtraction is also exact.
    exact: &'static [f64],
    /// Parts whose subtraction rounds; the rounding error is stored.
    compensated: &'static [f64],
    /// The remainder. (No part is negative, so that −0 is preserved.)
    last: f64,
}
const QUARTER_TURN_64: QuarterTurn = QuarterTurn {
    exact: &[1.5707963267341256],
    compensated: &[6.077100506303966e-11],
    last: 2.0222662487959506e-21,
};
const QUARTER_TURN_32: QuarterTurn = QuarterTurn {
    exact: &[1.5703125, 0.0004825592041015625],
    compensated: &[
        1.2665987014770508e-06,
        9.89530235528946e-10,
        2.5579538487363607e-12,
    ],
    last: 5.390302953474238e-15,
};

/// (sin x − x) / x³ as a polynomial in x² for |x| ≤ π/4.
const SINE_64: [f64; 6] = [
    -0.16666666666666632,
    0.008333333333322424,
    -0.00019841269829816538,
    2.7557313695083844e-06,
    -2.505075863080562e-08,
    1.5896826608749683e-10,
];
const SINE_32: [f64; 3] = [
    -0.16666654943396353,
    0.008332178126155885,
    -0.0001951729621002405,
];
/// (cos x − 1 + x²/2) / x⁴ as a polynomial in x² for |x| ≤ π/4.
const COSINE_64: [f64; 6] = [
    0.0416666666666666,
    -0.0013888888888874138,
    2.4801587289491536e-05,
    -2.75573143551531e-07,
    2.0875723671699116e-09,
    -1.1359669172594054e-11,
];
const COSINE_32: [f64; 3] = [
    0.04166664686614817,
    -0.0013887367499837145,
    2.4438449587385315e-05,
];
/// (atan t − t) / t³ as a polynomial in t² for |t| ≤ tan(π/8).
const ARC_TANGENT_64: [f64; 11] = [
    -0.333333333333332,
    0.19999999999954082,
    -0.14285714280248585,
    0.11111110786139128,
    -0.09090897836434896,
    0.07692061636187414,
    -0.06663120367352943,
    0.05848008760777935,
    -0.050398446792522485,
    0.03807829695962818,
    -0.017922250281083824,
];
const ARC_TANGENT_32: [f64; 5] = [
    -0.3333331550522542,
    0.19998489424520832,
    -0.1424384836736719,
    0.10595998068767148,
    -0.06083443162048795,
];

/// Computes sine and cosine.
///
/// x = q π/2 + y with q an integer and |y| ≤ π/4. Then (cos x, sin x) is (cos y, sin y) rotated by q quarter turns,
/// that is, multiplied as a complex number by (u, v) = (cos, sin)(q π/2), each −1, 0 or 1.
#[inline(always)]
pub(crate) fn sin_cos<T: Real>(x: T) -> (T, T) {
    // Past a quarter of the mantissa's integers, quarter turns cannot be distinguished; infinity becomes NaN.
    let limit = T::new(by_precision::<T, _>(f64::powi(2.0, 50), f64::powi(2.0, 21)));
    let x = T::select(x.abs().le(limit), x, x * T::ZERO);
    let (quarters, angle, tail) = reduce_to_quarter_turn(x);
    let (sine, cosine) = small_sin_cos(angle, tail);
    // q modulo 4, negated, in −2..=2, by arithmetic, without bit operations or branches. The order of the operations
    // makes v = −0 for q = 0, so that the sine of −0 is −0.
    let minus_q = T::new(4.0) * nearest_integer(quarters * T::new(0.25)) - quarters;
    let u = T::ONE - minus_q.abs();
    let v = minus_q * (minus_q.abs() - T::new(2.0));
    (sine * u + cosine * v, cosine * u - sine * v)
}

/// Returns (q, y, tail of y): Cody and Waite's reduction, with the rounding errors of the last parts.
#[inline(always)]
fn reduce_to_quarter_turn<T: Real>(x: T) -> (T, T, T) {
    let parts = by_precision::<T, _>(&QUARTER_TURN_64, &QUARTER_TURN_32);
    let quarters = nearest_integer(x * T::new(FRAC_2_PI));
    let mut rest = x;
    for &part in parts.exact {
        rest -= quarters * T::new(part);
    }
    let mut excess = quarters * T::new(parts.last);
    for &part in parts.compensated {
        let (sum, error) = two_sum(rest, quarters * T::new(-part));
        rest = sum;
        excess -= error;
    }
    let angle = rest - excess;
    (quarters, angle, (rest - angle) - excess)
}

/// Computes sine and cosine of `y + tail`, with |y| ≤ π/4 and the tail below y's last place.
#[inline(always)]
fn small_sin_cos<T: Real>(y: T, tail: T) -> (T, T) {
    let z = y * y;
    let half_z = z * T::new(0.5);
    let head = T::ONE - half_z;
    // The tail adds to the sine by the slope, cos y ≈ 1 − z/2, and to the cosine by −sin y ≈ −y. The sign is that of y;
    // only −0 needs the explicit copy.
    let sine = y + (z * y * polynomial(z, &SINE_64, &SINE_32) + tail * head);
    let sine = sine.copysign(y);
    let small = z * z * polynomial(z, &COSINE_64, &COSINE_32) - y * tail;
    // 1 − z/2 rounds; its error is added back with the small terms.
    let cosine = head + (((T::ONE - head) - half_z) + small);
    (sine, cosine)
}

/// Computes the angle of the point (x, y), in [−π, π]; signed zeros and infinities as in IEEE 754.
///
/// With s the smaller and l the larger of |x|, |y|, atan(s/l) is atan t or π/4 + atan t with t = s/l or
/// (s − l)/(s + l), |t| ≤ tan(π/8); reflections at the diagonal (|y| > |x|) and at the y axis (x < 0) then turn an
/// angle m π/4 + σ atan t into (2 − m) π/4 − σ atan t and (4 − m) π/4 − σ atan t.
#[kernel]
pub(crate) fn atan2<T: Real>(y: T, x: T) -> T {
    let (zero, one) = (T::ZERO, T::ONE);
    let steep = y.abs().gt(x.abs());
    let (s, l) = ratio_operands(T::select(steep, x, y).abs(), T::select(steep, y, x).abs());
    let folded = s.gt(l * T::new(SQRT_2 - 1.0));
    let (numerator, numerator_low) = ordered_sum(-T::select(folded, l, zero), s);
    let (denominator, denominator_low) = ordered_sum(l, T::select(folded, s, zero));
    let t = numerator / denominator;
    let t_low = (numerator_low - t * denominator_low) / denominator;
    let z = t * t;
    let arc = t + (t_low + t * z * polynomial(z, &ARC_TANGENT_64, &ARC_TANGENT_32));

    let mut eighths = T::select(folded, one, zero);
    eighths = T::select(steep, T::new(2.0) - eighths, eighths);
    let mut sign = T::select(steep, -one, one);
    let backward = one.copysign(x).lt(zero);
    eighths = T::select(backward, T::new(4.0) - eighths, eighths);
    sign = T::select(backward, -sign, sign);
    // π/4 in two parts. The first ends in zeros (in f64 by itself), so its multiples up to 4 are exact.
    let high = T::new(by_precision::<T, _>(FRAC_PI_4, 0.785398006439209));
    let low = T::new(by_precision::<T, _>(
        3.061616997868383e-17,
        1.5695823663008923e-07,
    ));
    let angle = eighths * high + (eighths * low + sign * arc);

    let not_nan = x.eq(x) & y.eq(y);
    T::select(not_nan, angle.copysign(y), T::new(f64::NAN))
}

/// Makes the smaller and the larger magnitude safe to divide and add: (0, 0) and (finite, ∞) become (0, 1), (∞, ∞)
/// becomes (1, 1), and numbers near overflow are scaled down.
#[inline(always)]
fn ratio_operands<T: Real>(s: T, l: T) -> (T, T) {
    let (zero, one) = (T::ZERO, T::ONE);
    let infinity = T::splat(T::Scalar::INFINITY);
    let quarter = T::new(0.25);
    let scale = T::select(l.gt(T::splat(T::Scalar::MAX) * quarter), quarter, one);
    let limit = T::select(s.eq(infinity), one, zero);
    let s = T::select(l.eq(infinity), limit, s * scale);
    let l = T::select(l.eq(infinity) | l.eq(zero), one, l * scale);
    (s, l)
}
