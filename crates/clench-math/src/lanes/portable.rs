//! Lanes as plain arrays, which the compiler translates to the instructions of its target.

use super::registers::Registers;
use crate::real::Scalar;
use std::array::from_fn;

/// No particular instruction set: plain arrays of any width from 1 to 32.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

// SAFETY: an array consists of its elements, and arrays need no particular instructions.
unsafe impl<S: Scalar, const N: usize> Registers<S, N> for Portable {
    type Vector = [S; N];
    type Mask = [bool; N];
    const ZERO: [S; N] = [S::ZERO; N];
    const ONE: [S; N] = [S::ONE; N];

    #[inline(always)]
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
        kernel()
    }

    #[inline(always)]
    fn from_array(values: [S; N]) -> [S; N] {
        values
    }
    #[inline(always)]
    fn to_array(v: [S; N]) -> [S; N] {
        v
    }
    #[inline(always)]
    fn splat(value: S) -> [S; N] {
        [value; N]
    }

    #[inline(always)]
    fn add(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn div(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn neg(a: [S; N]) -> [S; N] {
        from_fn(|i| -a[i])
    }
    #[inline(always)]
    fn abs(a: [S; N]) -> [S; N] {
        from_fn(|i| a[i].abs())
    }
    #[inline(always)]
    fn sqrt(a: [S; N]) -> [S; N] {
        from_fn(|i| a[i].sqrt())
    }
    #[inline(always)]
    fn min(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i].min(b[i]))
    }
    #[inline(always)]
    fn max(a: [S; N], b: [S; N]) -> [S; N] {
        from_fn(|i| a[i].max(b[i]))
    }
    #[inline(always)]
    fn copysign(a: [S; N], sign: [S; N]) -> [S; N] {
        from_fn(|i| a[i].copysign(sign[i]))
    }
    #[inline(always)]
    fn floor(a: [S; N]) -> [S; N] {
        from_fn(|i| a[i].floor())
    }
    #[inline(always)]
    fn exp2_integer(a: [S; N]) -> [S; N] {
        from_fn(|i| a[i].exp2_integer())
    }
    #[inline(always)]
    fn split_exponent(a: [S; N]) -> ([S; N], [S; N]) {
        let pairs = a.map(S::split_exponent);
        (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
    }
    #[inline(always)]
    fn lt(a: [S; N], b: [S; N]) -> [bool; N] {
        from_fn(|i| a[i] < b[i])
    }
    #[inline(always)]
    fn le(a: [S; N], b: [S; N]) -> [bool; N] {
        from_fn(|i| a[i] <= b[i])
    }
    #[inline(always)]
    fn eq(a: [S; N], b: [S; N]) -> [bool; N] {
        from_fn(|i| a[i] == b[i])
    }
    #[inline(always)]
    fn select(mask: [bool; N], yes: [S; N], no: [S; N]) -> [S; N] {
        from_fn(|i| if mask[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    fn mask_bits(mask: [bool; N]) -> u32 {
        const { assert!(0 < N && N <= 32, "there are 1 to 32 lanes") }
        (0..N).fold(0, |bits, i| bits | u32::from(mask[i]) << i)
    }
    #[inline(always)]
    fn mask_from_bits(bits: u32) -> [bool; N] {
        const { assert!(0 < N && N <= 32, "there are 1 to 32 lanes") }
        from_fn(|i| bits >> i & 1 != 0)
    }
    #[inline(always)]
    fn mask_and(a: [bool; N], b: [bool; N]) -> [bool; N] {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    fn mask_or(a: [bool; N], b: [bool; N]) -> [bool; N] {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn mask_not(mask: [bool; N]) -> [bool; N] {
        from_fn(|i| !mask[i])
    }
}
