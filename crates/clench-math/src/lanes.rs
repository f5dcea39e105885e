//! `Real` for N environments side by side.
//!
//! The representation is private: plain arrays, aligned so that a full register's worth of lanes never straddles a
//! cache line, which the compiler turns into the vector instructions of whatever target it compiles for.

use crate::real::{Mask, Real, Scalar};
use std::array::from_fn;
use std::ops::{
    Add, AddAssign, BitAnd, BitAndAssign, BitOr, BitOrAssign, Div, DivAssign, Mul, MulAssign, Neg,
    Not, Sub, SubAssign,
};

/// One number for each of `N` environments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<S, const N: usize>([S; N]);

/// One truth value for each of `N` environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const N: usize>([bool; N]);

impl<S: Scalar, const N: usize> Lanes<S, N> {
    /// One value a lane.
    #[inline(always)]
    pub const fn from_array(values: [S; N]) -> Self {
        Lanes(values)
    }
    /// The value of every lane.
    #[inline(always)]
    pub const fn to_array(self) -> [S; N] {
        self.0
    }
    /// Lane `i` holds `value(i)`.
    #[inline(always)]
    pub fn from_fn(value: impl FnMut(usize) -> S) -> Self {
        Lanes(from_fn(value))
    }
    /// The values, lane 0 first.
    #[inline(always)]
    pub fn iter(self) -> impl ExactSizeIterator<Item = S> {
        self.0.into_iter()
    }

    #[inline(always)]
    fn map(self, f: impl Fn(S) -> S) -> Self {
        Lanes(from_fn(|i| f(self.0[i])))
    }
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(S, S) -> S) -> Self {
        Lanes(from_fn(|i| f(self.0[i], other.0[i])))
    }
    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(S, S) -> bool) -> LaneMask<N> {
        LaneMask(from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl<S: Scalar, const N: usize> From<[S; N]> for Lanes<S, N> {
    fn from(values: [S; N]) -> Self {
        Lanes(values)
    }
}
impl<S: Scalar, const N: usize> From<Lanes<S, N>> for [S; N] {
    fn from(lanes: Lanes<S, N>) -> Self {
        lanes.0
    }
}
impl<S: Scalar, const N: usize> Default for Lanes<S, N> {
    fn default() -> Self {
        Self::ZERO
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident;)*) => {$(
        impl<S: Scalar, const N: usize> $operator for Lanes<S, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, S::$method)
            }
        }
        impl<S: Scalar, const N: usize> $assign for Lanes<S, N> {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = self.zip(other, S::$method);
            }
        }
    )*};
}
lane_by_lane! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

impl<S: Scalar, const N: usize> Neg for Lanes<S, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(S::neg)
    }
}

impl<S: Scalar, const N: usize> Real for Lanes<S, N> {
    type Scalar = S;
    type Mask = LaneMask<N>;
    const LANES: usize = N;
    const ZERO: Self = Lanes([S::ZERO; N]);
    const ONE: Self = Lanes([S::ONE; N]);

    #[inline(always)]
    fn new(value: f64) -> Self {
        Lanes([S::new(value); N])
    }
    #[inline(always)]
    fn splat(value: S) -> Self {
        Lanes([value; N])
    }
    #[inline(always)]
    fn lane(self, i: usize) -> S {
        self.0[i]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, value: S) {
        self.0[i] = value;
    }

    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        self.compare(other, <S as Real>::lt)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        self.compare(other, <S as Real>::le)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> LaneMask<N> {
        self.compare(other, <S as Real>::gt)
    }
    #[inline(always)]
    fn ge(self, other: Self) -> LaneMask<N> {
        self.compare(other, <S as Real>::ge)
    }
    #[inline(always)]
    fn eq(self, other: Self) -> LaneMask<N> {
        self.compare(other, <S as Real>::eq)
    }
    #[inline(always)]
    fn is_finite(self) -> LaneMask<N> {
        LaneMask(self.0.map(S::is_finite))
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        Lanes(from_fn(|i| S::select(mask.0[i], yes.0[i], no.0[i])))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(S::abs)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(S::sqrt)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, S::min)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, S::max)
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.zip(sign, S::copysign)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(S::floor)
    }
    #[inline(always)]
    fn exp2_integer(self) -> Self {
        self.map(S::exp2_integer)
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let pairs = self.0.map(S::split_exponent);
        (Lanes(pairs.map(|p| p.0)), Lanes(pairs.map(|p| p.1)))
    }
}

impl<const N: usize> LaneMask<N> {
    /// One truth value a lane.
    #[inline(always)]
    pub const fn from_array(values: [bool; N]) -> Self {
        LaneMask(values)
    }
    /// The truth value of every lane.
    #[inline(always)]
    pub const fn to_array(self) -> [bool; N] {
        self.0
    }
    /// The truth values, lane 0 first.
    #[inline(always)]
    pub fn iter(self) -> impl ExactSizeIterator<Item = bool> {
        self.0.into_iter()
    }
}

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        LaneMask([value; N])
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.into_iter().fold(false, |any, lane| any | lane)
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.into_iter().fold(true, |all, lane| all & lane)
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0[i]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, value: bool) {
        self.0[i] = value;
    }
}

impl<const N: usize> BitAnd for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        LaneMask(from_fn(|i| self.0[i] & other.0[i]))
    }
}
impl<const N: usize> BitOr for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        LaneMask(from_fn(|i| self.0[i] | other.0[i]))
    }
}
impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        LaneMask(self.0.map(|lane| !lane))
    }
}
impl<const N: usize> BitAndAssign for LaneMask<N> {
    #[inline(always)]
    fn bitand_assign(&mut self, other: Self) {
        *self = *self & other;
    }
}
impl<const N: usize> BitOrAssign for LaneMask<N> {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}
