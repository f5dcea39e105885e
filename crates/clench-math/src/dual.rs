//! Dual numbers: a value and its derivatives along several directions.
//!
//! A kernel generic over [`Real`] that runs on dual numbers computes the exact derivatives of its results (forward-mode
//! differentiation; Griewank & Walther, *Evaluating Derivatives*, 2008, chapter 3). Values follow the arithmetic of
//! `f64` to the bit, so every branch is taken as in plain numbers: the derivative is that of the active side.
//!
//! Every derivative is finite. At a point where a function has none, that of a root at zero, of the angle of the point
//! (0, 0) and of a power at zero is 0, that of `abs` at ±0 is ±1.

use crate::lanes::{Instructions, LaneTask};
use crate::real::{Mask, Real, Scalar};
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value and its derivatives along `K` × `L::LANES` directions.
///
/// Comparisons of order read the values alone. Two numbers are equal if their derivatives are equal too, so that code
/// that skips zeros skips no derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Dual<L, const K: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives, direction after direction.
    pub tangent: [L; K],
}

impl<L: Real<Scalar = f64>, const K: usize> Dual<L, K> {
    /// The number of directions.
    pub const DIRECTIONS: usize = K * L::LANES;

    const fn constant(value: f64) -> Self {
        Dual {
            value,
            tangent: [L::ZERO; K],
        }
    }

    /// Returns the derivative along one direction.
    pub fn derivative(&self, direction: usize) -> f64 {
        L::as_scalars(&self.tangent)[direction]
    }

    /// Sets the derivative along one direction.
    pub fn set_derivative(&mut self, direction: usize, derivative: f64) {
        L::as_scalars_mut(&mut self.tangent)[direction] = derivative;
    }

    /// Returns f of this number, from f and its derivative at the value.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        let slope = L::splat(slope);
        let mut tangent = self.tangent;
        each::<K>(|k| tangent[k] *= slope);
        Dual { value, tangent }
    }

    /// Returns f of two numbers, from f and its derivatives by each.
    #[inline(always)]
    fn chain2(self, other: Self, value: f64, slopes: (f64, f64)) -> Self {
        let (a, b) = (L::splat(slopes.0), L::splat(slopes.1));
        let mut tangent = self.tangent;
        each::<K>(|k| tangent[k] = tangent[k] * a + other.tangent[k] * b);
        Dual { value, tangent }
    }
}

impl<L: Real<Scalar = f64>, const K: usize> Default for Dual<L, K> {
    #[inline(always)]
    fn default() -> Self {
        Self::ZERO
    }
}

impl<L: Real<Scalar = f64>, const K: usize> fmt::Display for Dual<L, K> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.value.fmt(f)
    }
}

impl<L: Real<Scalar = f64>, const K: usize> PartialEq for Dual<L, K> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        let mut tangents = self.tangent.iter().zip(&other.tangent);
        self.value == other.value && tangents.all(|(&x, &y)| x.eq(y).all())
    }
}

impl<L: Real<Scalar = f64>, const K: usize> PartialOrd for Dual<L, K> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.value <= other.value
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        self.value > other.value
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        self.value >= other.value
    }
}

impl<L: Real<Scalar = f64>, const K: usize> Add for Dual<L, K> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}
impl<L: Real<Scalar = f64>, const K: usize> AddAssign for Dual<L, K> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        each::<K>(|k| self.tangent[k] += other.tangent[k]);
    }
}
impl<L: Real<Scalar = f64>, const K: usize> Sub for Dual<L, K> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}
impl<L: Real<Scalar = f64>, const K: usize> SubAssign for Dual<L, K> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.value -= other.value;
        each::<K>(|k| self.tangent[k] -= other.tangent[k]);
    }
}
impl<L: Real<Scalar = f64>, const K: usize> Mul for Dual<L, K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, (other.value, self.value))
    }
}
impl<L: Real<Scalar = f64>, const K: usize> MulAssign for Dual<L, K> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
impl<L: Real<Scalar = f64>, const K: usize> Div for Dual<L, K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = 1.0 / other.value;
        self.chain2(other, value, (inverse, -value * inverse))
    }
}
impl<L: Real<Scalar = f64>, const K: usize> DivAssign for Dual<L, K> {
    #[inline(always)]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}
impl<L: Real<Scalar = f64>, const K: usize> Neg for Dual<L, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        self.value = -self.value;
        each::<K>(|k| self.tangent[k] = -self.tangent[k]);
        self
    }
}

/// Calls `f` with each index below `K`. A loop over an iterator takes much longer to compile, and every kernel contains
/// these operations.
#[inline(always)]
fn each<const K: usize>(mut f: impl FnMut(usize)) {
    let mut k = 0;
    while k < K {
        f(k);
        k += 1;
    }
}

/// Returns `slope`, or 0 where it is not finite.
#[inline(always)]
fn finite_or_zero(slope: f64) -> f64 {
    if slope.is_finite() { slope } else { 0.0 }
}

impl<L: Real<Scalar = f64>, const K: usize> Real for Dual<L, K> {
    type Scalar = Self;
    type Value = f64;
    type Mask = bool;
    type Clock = f64;
    const LANES: usize = 1;
    const ZERO: Self = Self::constant(0.0);
    const ONE: Self = Self::constant(1.0);
    const IS_DUAL: bool = true;

    #[inline(always)]
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
        // The derivatives of each number are contiguous.
        L::vectorize_rows(kernel)
    }
    #[inline(always)]
    fn vectorize_rows<R>(kernel: impl FnOnce() -> R) -> R {
        L::vectorize_rows(kernel)
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn set_value(&mut self, value: f64) {
        self.value = value;
    }
    fn map_tangents(x: &mut [Self], scratch: &mut Vec<f64>, mut map: impl FnMut(&mut [f64])) {
        for direction in 0..Self::DIRECTIONS {
            scratch.clear();
            scratch.extend(x.iter().map(|x| x.derivative(direction)));
            map(scratch);
            for (x, &derivative) in x.iter_mut().zip(&*scratch) {
                x.set_derivative(direction, derivative);
            }
        }
    }

    #[inline(always)]
    fn scale(self, constant: f64) -> Self {
        self.chain(self.value * constant, constant)
    }

    #[inline(always)]
    fn as_scalars(values: &[Self]) -> &[Self] {
        values
    }
    #[inline(always)]
    fn as_scalars_mut(values: &mut [Self]) -> &mut [Self] {
        values
    }
    #[inline(always)]
    fn new(value: f64) -> Self {
        Self::constant(value)
    }
    #[inline(always)]
    fn splat(value: Self) -> Self {
        value
    }
    #[inline(always)]
    fn lane(self, _: usize) -> Self {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: Self) {
        *self = value;
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    #[inline(always)]
    fn gt(self, other: Self) -> bool {
        self.value > other.value
    }
    #[inline(always)]
    fn ge(self, other: Self) -> bool {
        self.value >= other.value
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        if self.value.is_sign_negative() {
            -self
        } else {
            self
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, finite_or_zero(0.5 / root))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.value < other.value {
            self
        } else {
            other
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.value > other.value {
            self
        } else {
            other
        }
    }
    /// At an end of the range the derivative is that of the inside: a control at its limit can still be lowered.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        if low.value < high.value && (low.value..=high.value).contains(&self.value) {
            self
        } else {
            self.max(low).min(high)
        }
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        if self.value.is_sign_negative() == sign.value.is_sign_negative() {
            self
        } else {
            -self
        }
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    #[inline(always)]
    fn exp2_integer(self) -> Self {
        Self::constant(Real::exp2_integer(self.value))
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let (exponent, mantissa) = Real::split_exponent(self.value);
        let slope = finite_or_zero(mantissa / self.value);
        (Self::constant(exponent), self.chain(mantissa, slope))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = Real::sin_cos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let angle = Real::atan2(self.value, x.value);
        let square = self.value * self.value + x.value * x.value;
        let slopes = (x.value / square, -self.value / square);
        self.chain2(
            x,
            angle,
            (finite_or_zero(slopes.0), finite_or_zero(slopes.1)),
        )
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = Real::exp(self.value);
        self.chain(value, value)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(Real::ln(self.value), finite_or_zero(1.0 / self.value))
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        let value = Real::powf(self.value, exponent.value);
        let by_base = match exponent.value == 0.0 {
            true => 0.0,
            false => exponent.value * Real::powf(self.value, exponent.value - 1.0),
        };
        let by_exponent = value * Real::ln(self.value);
        let slopes = (finite_or_zero(by_base), finite_or_zero(by_exponent));
        self.chain2(exponent, value, slopes)
    }
}

impl<L: Real<Scalar = f64>, const K: usize> Scalar for Dual<L, K> {
    type SingleEnv = Self;
    type Double = Self;
    const SINGLE_ENV: Instructions = Instructions::Scalar;
    const EPSILON: Self = Self::constant(f64::EPSILON);
    const INFINITY: Self = Self::constant(f64::INFINITY);
    const MAX: Self = Self::constant(f64::MAX);
    const MIN_POSITIVE: Self = Self::constant(f64::MIN_POSITIVE);
    const DIGITS: u32 = f64::MANTISSA_DIGITS;
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn to_double(self) -> Self {
        self
    }
    #[inline(always)]
    fn from_double(value: Self) -> Self {
        value
    }
    /// Runs a task one environment at a time: dual numbers have no lanes of environments.
    #[inline(always)]
    fn in_lanes<Task: LaneTask<Self>>(
        instructions: Instructions,
        task: Task,
    ) -> Option<Task::Output> {
        (instructions == Instructions::Scalar).then(|| task.run::<Self>())
    }
}
