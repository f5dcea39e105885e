//! The number type of kernels.
//!
//! A kernel generic over `T: Real` works for one environment (`f64`, `f32`) and for many (`Lanes<f64, N>`,
//! `Lanes<f32, N>`) with the same source. Differences between environments are expressed by a [`Mask`] and a
//! [`select`](Real::select). A branch on [`Mask::any`] keeps the one-environment case as fast as plain code.

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
    /// Creates the same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// Returns true if at least one lane is true.
    fn any(self) -> bool;
    /// Returns true if every lane is true.
    fn all(self) -> bool;
    /// Returns the number of lanes that are true.
    fn count(self) -> usize;
    /// Returns the truth value of lane `i`.
    fn lane(self, i: usize) -> bool;
    /// Sets the truth value of lane `i`.
    fn set_lane(&mut self, i: usize, value: bool);
}

/// A time for each environment, s. It is in double precision, because it accumulates millions of small steps.
pub trait Clock: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Creates the same time in every lane.
    fn splat(time: f64) -> Self;
    /// Returns the time of lane `i`.
    fn lane(self, i: usize) -> f64;
    /// Sets the time of lane `i`.
    fn set_lane(&mut self, i: usize, time: f64);
}

/// A real number for each environment, with IEEE arithmetic lane by lane.
///
/// Every operation on lanes equals the scalar operation to the bit (except which NaN results). No fused multiply-add is
/// ever used, so results do not depend on the processor. `min` and `max` return the second operand if the comparison
/// fails (NaN included).
///
/// On a concrete `f64` or `f32` an inherent method of the same name takes precedence (`x.sin_cos()` is the standard
/// library's). Kernels are generic; concrete code that must agree with them writes `Real::sin_cos(x)`.
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
    /// The number without derivatives: the number itself, except for [`Dual`](crate::Dual) numbers.
    type Value: Real<Mask = Self::Mask, Clock = Self::Clock, Value = Self::Value>;
    /// One truth value per lane.
    type Mask: Mask;
    /// One time per lane.
    type Clock: Clock;
    /// The number of environments in this number.
    const LANES: usize;
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// True if the number carries derivatives.
    const IS_DUAL: bool = false;

    /// Runs a closure compiled for the instructions of these lanes; [`kernel`](crate::kernel) does so for whole
    /// functions.
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R;

    /// Does the same for a closure whose loops run over contiguous numbers, so that it fills the registers of this
    /// processor even if a number is a scalar. Results do not depend on the choice: nothing is fused or summed in
    /// another order.
    fn vectorize_rows<R>(kernel: impl FnOnce() -> R) -> R;

    /// Returns the number without its derivatives.
    fn value(self) -> Self::Value;
    /// Sets the value and keeps the derivatives.
    fn set_value(&mut self, value: Self::Value);
    /// Creates a number without derivatives.
    #[inline(always)]
    fn from_value(value: Self::Value) -> Self {
        let mut number = Self::ZERO;
        number.set_value(value);
        number
    }
    /// Applies a linear map to the derivatives of `x` along each direction. Does nothing for numbers without any.
    fn map_tangents(
        x: &mut [Self],
        scratch: &mut Vec<Self::Value>,
        map: impl FnMut(&mut [Self::Value]),
    );

    /// Multiplies by a constant.
    #[inline(always)]
    fn scale(self, constant: f64) -> Self {
        self * Self::new(constant)
    }

    /// Creates the same constant in every lane, rounded to the lane's precision.
    fn new(value: f64) -> Self;
    /// Creates the same value in every lane.
    fn splat(value: Self::Scalar) -> Self;
    /// Returns the value of lane `i`.
    fn lane(self, i: usize) -> Self::Scalar;
    /// Returns the value of lane `i` in double precision.
    #[inline(always)]
    fn lane_in_double(self, i: usize) -> Double<Self> {
        self.lane(i).to_double()
    }
    /// Sets the value of lane `i`.
    fn set_lane(&mut self, i: usize, value: Self::Scalar);

    /// Returns the lanes of many numbers, number after number.
    fn as_scalars(values: &[Self]) -> &[Self::Scalar];
    /// Returns the lanes of many numbers for writing.
    fn as_scalars_mut(values: &mut [Self]) -> &mut [Self::Scalar];

    /// Computes `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// Computes `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// Computes `self > other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// Computes `self >= other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// Computes `self == other`.
    fn eq(self, other: Self) -> Self::Mask;
    /// Returns true in lanes that are neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;
    /// Returns `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Computes the absolute value.
    fn abs(self) -> Self;
    /// Computes the square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Returns the smaller of two.
    fn min(self, other: Self) -> Self;
    /// Returns the larger of two.
    fn max(self, other: Self) -> Self;
    /// Returns the magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Returns the largest integer not above `self`.
    fn floor(self) -> Self;

    /// Computes 2 to the power `self`, an integer within the exponents of normal numbers (−1022..=1023, in `f32`
    /// −126..=127). Any other argument gives an unspecified number.
    fn exp2_integer(self) -> Self;
    /// Returns (k, m) with `self` = 2ᵏ m and m in [√½, √2), for a positive normal number. Any other argument gives
    /// unspecified numbers.
    fn split_exponent(self) -> (Self, Self);

    /// Computes sine and cosine of an angle in radians, to about one unit in the last place up to 10⁶ rad (10⁵ in
    /// `f32`).
    ///
    /// Beyond, the error is at most that of an argument off by one unit in its last place. Past 2⁵⁰ rad (2²¹), where
    /// that unit is a quarter of a radian, the angle counts as 0. Infinity and NaN give NaN.
    fn sin_cos(self) -> (Self, Self);
    /// Computes the angle of the point (`x`, `self`), in [−π, π], rad; signed zeros and infinities as in IEEE 754.
    fn atan2(self, x: Self) -> Self;
    /// Computes the exponential.
    fn exp(self) -> Self;
    /// Computes the natural logarithm; −∞ at zero, NaN below.
    fn ln(self) -> Self;
    /// Raises `self` ≥ 0 to a real power; NaN below zero. Anything to the power 0 is 1.
    fn powf(self, exponent: Self) -> Self;

    /// Computes the sine of an angle in radians.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// Computes the cosine of an angle in radians.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Clamps to `[low, high]`.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// Computes the square.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}

/// The type of computations in double precision for one lane of a type.
pub type Double<T> = <<T as Real>::Scalar as Scalar>::Double;

/// A `Real` of one lane, which can also be compared and branched on directly.
pub trait Scalar:
    Real<Scalar = Self, Mask = bool, Clock = f64> + PartialOrd + std::fmt::Display
{
    /// The number type for computing one environment: the scalar itself, or lanes of it that all hold the same numbers.
    /// Its values may exist only if the instructions [`SINGLE_ENV`](Self::SINGLE_ENV) are available.
    type SingleEnv: Real<Scalar = Self>;
    /// The number type of computations for which single precision is too coarse: `f64` for `f32`, else the scalar.
    type Double: Scalar;
    /// The instructions of [`SingleEnv`](Self::SingleEnv).
    const SINGLE_ENV: Instructions;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// The largest finite number.
    const MAX: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// The number of binary digits of the mantissa, including the implicit one: 53 or 24.
    const DIGITS: u32;
    /// True for single precision, whose rounding needs its own floors and factors.
    const IS_SINGLE: bool = Self::DIGITS == f32::MANTISSA_DIGITS;
    /// Converts the value to `f64`.
    fn to_f64(self) -> f64;
    /// Converts to [`Double`](Self::Double).
    fn to_double(self) -> Self::Double;
    /// Rounds a [`Double`](Self::Double).
    fn from_double(value: Self::Double) -> Self;
    /// Returns true if the absolute values of all numbers are at most `limit`. It is compiled for speed in every crate.
    fn all_within(values: &[Self], limit: Self) -> bool {
        values.iter().all(|x| x.abs().le(limit))
    }
    /// Runs a task in lanes of these instructions; `None` if they are not available.
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
