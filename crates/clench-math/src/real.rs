//! The number that kernels are written in.
//!
//! A kernel generic over `T: Real` serves one environment (`f64`, `f32`) and many (`Lanes<f64, N>`,
//! `Lanes<f32, N>`) with the same source. What differs between environments is a [`Mask`] and a
//! [`select`](Real::select); a branch on [`Mask::any`] keeps the one-environment case as fast as plain code.

use std::fmt::Debug;
use std::ops::{
    Add, AddAssign, BitAnd, BitAndAssign, BitOr, BitOrAssign, Div, DivAssign, Mul, MulAssign, Neg,
    Not, Sub, SubAssign,
};

/// A truth value for each environment.
pub trait Mask:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Not<Output = Self>
    + BitAndAssign
    + BitOrAssign
{
    /// The same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// True where at least one lane is.
    fn any(self) -> bool;
    /// True where every lane is.
    fn all(self) -> bool;
    /// The truth value of lane `i`.
    fn lane(self, i: usize) -> bool;
    /// Sets the truth value of lane `i`.
    fn set_lane(&mut self, i: usize, value: bool);
}

/// A real number for each environment, with IEEE arithmetic lane by lane.
///
/// Every operation on lanes equals the scalar operation to the bit. No fused multiply-add is ever used, so results
/// do not depend on the processor. `min`, `max` return the second operand where the comparison fails (NaN included).
pub trait Real:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The type of one lane: `f64` or `f32`.
    type Scalar: Scalar;
    /// One truth value a lane.
    type Mask: Mask;
    /// How many environments share this number.
    const LANES: usize;
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The same constant in every lane, rounded to the lane's precision.
    fn new(value: f64) -> Self;
    /// The same value in every lane.
    fn splat(value: Self::Scalar) -> Self;
    /// The value of lane `i`.
    fn lane(self, i: usize) -> Self::Scalar;
    /// Sets the value of lane `i`.
    fn set_lane(&mut self, i: usize, value: Self::Scalar);

    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `self > other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// `self >= other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// `self == other`.
    fn eq(self, other: Self) -> Self::Mask;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    fn max(self, other: Self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Largest integer not above.
    fn floor(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the point (`x`, `self`), in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// `self` raised to a real power; `self` ≥ 0.
    fn powf(self, exponent: Self) -> Self;

    /// Sine of an angle in radians.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// Cosine of an angle in radians.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Clamps to `[low, high]`.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// The square.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}

/// A `Real` of one lane, which can also be compared and branched on directly.
pub trait Scalar: Real<Scalar = Self, Mask = bool> + PartialOrd + std::fmt::Display {
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Widens (or keeps) the value.
    fn to_f64(self) -> f64;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> bool {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: bool) {
        *self = value;
    }
}
