//! The interface that an instruction set provides for lanes.

use crate::real::Scalar;

/// The registers of an instruction set that hold `N` numbers of type `S`, and its operations on them.
///
/// In each lane an operation equals that of the scalar, to the bit (see [`Real`](crate::Real)).
///
/// # Safety
/// `Vector` must consist of exactly `N` numbers one after the other, and any numbers must be valid.
///
/// Methods run instructions that the processor may lack, though they are safe to call. So an implementor other than
/// `Portable` must have no name outside this module, which passes it to tasks only after detection
/// ([`Scalar::in_lanes`](crate::Scalar::in_lanes)): a caller of a method always runs on a processor that has it.
pub unsafe trait Registers<S: Scalar, const N: usize>: Copy + Send + Sync + 'static {
    /// `N` numbers.
    type Vector: Copy + Send + Sync + 'static;
    /// `N` truth values.
    type Mask: Copy + Send + Sync + 'static;
    /// Zeros.
    const ZERO: Self::Vector;
    /// Ones.
    const ONE: Self::Vector;

    /// Runs a closure that is compiled for the instruction set.
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R;

    fn from_array(values: [S; N]) -> Self::Vector;
    fn to_array(v: Self::Vector) -> [S; N];
    fn splat(value: S) -> Self::Vector;

    fn add(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn sub(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn mul(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn div(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn neg(a: Self::Vector) -> Self::Vector;
    fn abs(a: Self::Vector) -> Self::Vector;
    fn sqrt(a: Self::Vector) -> Self::Vector;
    fn min(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn max(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn copysign(a: Self::Vector, sign: Self::Vector) -> Self::Vector;
    fn floor(a: Self::Vector) -> Self::Vector;
    fn exp2_integer(a: Self::Vector) -> Self::Vector;
    fn split_exponent(a: Self::Vector) -> (Self::Vector, Self::Vector);

    fn lt(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    fn le(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    fn eq(a: Self::Vector, b: Self::Vector) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self::Vector, no: Self::Vector) -> Self::Vector;

    /// Returns the mask as bits: bit `i` is lane `i`; higher bits are zero.
    fn mask_bits(mask: Self::Mask) -> u32;
    /// Creates a mask from bits; the inverse of [`mask_bits`](Self::mask_bits).
    fn mask_from_bits(bits: u32) -> Self::Mask;
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn mask_or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn mask_not(mask: Self::Mask) -> Self::Mask;
}
