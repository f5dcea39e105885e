//! Error-free sums and products: a pair (value, error) represents their exact sum.
//!
//! Dekker, *A floating-point technique for extending the available precision* (1971); Knuth, *The Art of Computer
//! Programming*, volume 2, 4.2.2.

use super::polynomial::by_precision;
use crate::Real;

/// Computes a + b.
#[inline(always)]
pub(super) fn two_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// Computes a + b for |a| ≥ |b|.
#[inline(always)]
pub(super) fn ordered_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Computes a × b, if neither is within a few bits of overflow.
#[inline(always)]
pub(super) fn two_product<T: Real>(a: T, b: T) -> (T, T) {
    let product = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    let error = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
    (product, error)
}

/// Splits a mantissa into two halves whose products are exact.
#[inline(always)]
fn halves<T: Real>(x: T) -> (T, T) {
    // 2²⁷ + 1 and 2¹² + 1: half the digits, rounded up.
    let scaled = x * T::new(by_precision::<T, _>(134_217_729.0, 4097.0));
    let high = scaled - (scaled - x);
    (high, x - high)
}
