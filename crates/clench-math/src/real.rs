//! The number that kernels are written in.
//!
//! A kernel generic over `T: Real` serves one environment (`f64`, `f32`) and many (`Lanes<f64, N>`,
//! `Lanes<f32, N>`) with the same source. What differs between environments is a [`Mask`] and a
//! [`select`](Real::select); a branch on [`Mask::any`] keeps the one-environment case as fast as plain code.

use crate::{Instructions, LaneTask};
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
    /// In how many lanes it is true.
    fn count(self) -> usize;
    /// The truth value of lane `i`.
    fn lane(self, i: usize) -> bool;
    /// Sets the truth value of lane `i`.
    fn set_lane(&mut self, i: usize, value: bool);
}

/// A time for each environment, s, in double precision whatever the precision of its other numbers: a clock adds up small
/// steps, a million times.
pub trait Clock: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The same time in every lane.
    fn splat(time: f64) -> Self;
    /// The time of lane `i`.
    fn lane(self, i: usize) -> f64;
    /// Sets the time of lane `i`.
    fn set_lane(&mut self, i: usize, time: f64);
}

/// A real number for each environment, with IEEE arithmetic lane by lane.
///
/// Every operation on lanes equals the scalar operation to the bit (which of the NaNs comes out is left open). No fused
/// multiply-add is ever used, so results do not depend on the processor. `min`, `max` return the second operand where
/// the comparison fails (NaN included).
///
/// On a concrete `f64` or `f32` an inherent method of the same name comes first (`x.sin_cos()` is the standard
/// library's); kernels are generic, and concrete code that must agree with them writes `Real::sin_cos(x)`.
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
    /// One time a lane.
    type Clock: Clock;
    /// How many environments share this number.
    const LANES: usize;
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// Runs a closure compiled for the instructions that these lanes are made of; [`kernel`](crate::kernel) wraps whole
    /// functions so.
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R;

    /// The same for a closure whose loops run over contiguous numbers, so that the registers of this processor can be filled even where a
    /// number is a scalar. The choice changes no result: nothing is fused or summed in another order.
    fn vectorize_rows<R>(kernel: impl FnOnce() -> R) -> R;

    /// The same constant in every lane, rounded to the lane's precision.
    fn new(value: f64) -> Self;
    /// The same value in every lane.
    fn splat(value: Self::Scalar) -> Self;
    /// The value of lane `i`.
    fn lane(self, i: usize) -> Self::Scalar;
    /// Sets the value of lane `i`.
    fn set_lane(&mut self, i: usize, value: Self::Scalar);

    /// The lanes of many numbers, number after number.
    fn as_scalars(values: &[Self]) -> &[Self::Scalar];
    /// The lanes of many numbers, to be written.
    fn as_scalars_mut(values: &mut [Self]) -> &mut [Self::Scalar];

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

    /// 2 to the power `self`, an integer within the exponents of normal numbers (−1022..=1023, in `f32`
    /// −126..=127); any other argument gives an unspecified number.
    fn exp2_integer(self) -> Self;
    /// (k, m) with `self` = 2ᵏ m and m in [√½, √2), for a positive normal number; any other argument gives
    /// unspecified numbers.
    fn split_exponent(self) -> (Self, Self);

    /// Sine and cosine of an angle in radians, to about one unit in the last place up to 10⁶ rad (10⁵ in `f32`).
    ///
    /// Beyond, the error is at most that of an argument off by its own last place; past 2⁵⁰ rad (2²¹), where that place
    /// is worth a quarter of a radian, the angle counts as 0. Infinity and NaN give NaN.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the point (`x`, `self`), in [−π, π], rad; signed zeros and infinities as in IEEE 754.
    fn atan2(self, x: Self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm; −∞ at zero, NaN below.
    fn ln(self) -> Self;
    /// `self` ≥ 0 raised to a real power; NaN below zero. Anything to the power 0 is 1.
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
pub trait Scalar:
    Real<Scalar = Self, Mask = bool, Clock = f64> + PartialOrd + std::fmt::Display
{
    /// The number type that one environment is computed in: the scalar itself, or lanes of it, which then all hold the same numbers.
    /// Its values may exist only where the instructions [`ALONE`](Self::ALONE) are available.
    type Alone: Real<Scalar = Self>;
    /// The instructions that [`Alone`](Self::Alone) is made of.
    const ALONE: Instructions;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// The largest finite number.
    const MAX: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// Binary digits of the mantissa, the implicit one included: 53 or 24.
    const DIGITS: u32;
    /// Widens (or keeps) the value.
    fn to_f64(self) -> f64;
    /// Runs a task in lanes of these instructions; `None` if the processor lacks them.
    fn in_lanes<K: LaneTask<Self>>(instructions: Instructions, task: K) -> Option<K::Output>;
}

impl Clock for f64 {
    #[inline(always)]
    fn splat(time: f64) -> f64 {
        time
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, time: f64) {
        *self = time;
    }
}

impl<const N: usize> Clock for [f64; N] {
    #[inline(always)]
    fn splat(time: f64) -> Self {
        [time; N]
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self[i]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, time: f64) {
        self[i] = time;
    }
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
    fn count(self) -> usize {
        usize::from(self)
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
