//! `Real` for N environments in parallel.
//!
//! [`Lanes`] implements the operations of a number on the registers of an instruction set; [`Registers`] is the
//! interface that an instruction set must provide.
//!
//! All `unsafe` code of the crate is here, for two reasons. First, intrinsics and functions compiled for an instruction
//! set must not run on a processor that lacks it. So sets other than [`Portable`] have no public name, and `dispatch`
//! passes lanes of them to a [`LaneTask`] only after detecting them. ([`Scalar::SingleEnv`] can also be lanes; its
//! users check [`Scalar::SINGLE_ENV`] first.) Second, lanes are accessed as the plain numbers that they consist of.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub(crate) mod dispatch;
#[cfg(target_arch = "aarch64")]
mod neon;
mod portable;
mod registers;

use crate::elementary::elementary_functions;
use crate::real::{Mask, Real, Scalar};
pub use dispatch::{Instructions, LaneTask};
pub use portable::Portable;
use registers::Registers;
use std::array::from_fn;
use std::fmt;
use std::ops::{
    Add, AddAssign, BitAnd, BitAndAssign, BitOr, BitOrAssign, Div, DivAssign, Mul, MulAssign, Neg,
    Not, Sub, SubAssign,
};
use std::slice::{from_mut, from_ref};

/// One number for each of `N` environments, in the registers of the instruction set `I`.
#[derive(Copy)]
#[repr(transparent)]
pub struct Lanes<S: Scalar, const N: usize, I: Registers<S, N> = Portable>(I::Vector);

/// One truth value for each of `N` environments.
#[derive(Copy)]
#[repr(transparent)]
pub struct LaneMask<S: Scalar, const N: usize, I: Registers<S, N> = Portable>(I::Mask);

impl<S: Scalar, const N: usize, I: Registers<S, N>> Lanes<S, N, I> {
    /// Creates lanes from one value per lane.
    #[inline(always)]
    pub fn from_array(values: [S; N]) -> Self {
        Lanes(I::from_array(values))
    }
    /// Returns the value of every lane.
    #[inline(always)]
    pub fn to_array(self) -> [S; N] {
        I::to_array(self.0)
    }
    /// Creates lanes in which lane `i` holds `value(i)`.
    #[inline(always)]
    pub fn from_fn(value: impl FnMut(usize) -> S) -> Self {
        Self::from_array(from_fn(value))
    }
    /// Returns the values, lane 0 first.
    #[inline(always)]
    pub fn iter(self) -> impl ExactSizeIterator<Item = S> {
        self.to_array().into_iter()
    }
}

// Implemented by hand, since a derived method need not be inlined.
impl<S: Scalar, const N: usize, I: Registers<S, N>> Clone for Lanes<S, N, I> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> Clone for LaneMask<S, N, I> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> From<[S; N]> for Lanes<S, N, I> {
    #[inline(always)]
    fn from(values: [S; N]) -> Self {
        Self::from_array(values)
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> From<Lanes<S, N, I>> for [S; N] {
    #[inline(always)]
    fn from(lanes: Lanes<S, N, I>) -> Self {
        lanes.to_array()
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> Default for Lanes<S, N, I> {
    #[inline(always)]
    fn default() -> Self {
        Self::ZERO
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> PartialEq for Lanes<S, N, I> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.to_array() == other.to_array()
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> fmt::Debug for Lanes<S, N, I> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.to_array().fmt(f)
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident;)*) => {$(
        impl<S: Scalar, const N: usize, I: Registers<S, N>> $operator for Lanes<S, N, I> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes(I::$method(self.0, other.0))
            }
        }
        impl<S: Scalar, const N: usize, I: Registers<S, N>> $assign for Lanes<S, N, I> {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                self.0 = I::$method(self.0, other.0);
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

impl<S: Scalar, const N: usize, I: Registers<S, N>> Neg for Lanes<S, N, I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(I::neg(self.0))
    }
}

impl<S: Scalar, const N: usize, I: Registers<S, N>> Real for Lanes<S, N, I> {
    type Scalar = S;
    type Value = Self;
    type Mask = LaneMask<S, N, I>;
    type Clock = [f64; N];
    const LANES: usize = N;
    const ZERO: Self = Lanes(I::ZERO);
    const ONE: Self = Lanes(I::ONE);

    #[inline(always)]
    fn value(self) -> Self {
        self
    }
    #[inline(always)]
    fn set_value(&mut self, value: Self) {
        *self = value;
    }
    #[inline(always)]
    fn map_tangents(_: &mut [Self], _: &mut Vec<Self>, _: impl FnMut(&mut [Self])) {}

    #[inline(always)]
    fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
        I::vectorize(kernel)
    }
    #[inline(always)]
    fn vectorize_rows<R>(kernel: impl FnOnce() -> R) -> R {
        I::vectorize(kernel)
    }

    #[inline(always)]
    fn new(value: f64) -> Self {
        Self::splat(S::new(value))
    }
    #[inline(always)]
    fn splat(value: S) -> Self {
        Lanes(I::splat(value))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> S {
        Self::as_scalars(from_ref(&self))[i]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, value: S) {
        // One store; an array would be copied back and forth.
        Self::as_scalars_mut(from_mut(self))[i] = value;
    }
    #[inline(always)]
    fn as_scalars(values: &[Self]) -> &[S] {
        // SAFETY: the registers of an instruction set consist of N numbers one after the other.
        unsafe { std::slice::from_raw_parts(values.as_ptr().cast(), N * values.len()) }
    }
    #[inline(always)]
    fn as_scalars_mut(values: &mut [Self]) -> &mut [S] {
        // SAFETY: as above, and any numbers are valid lanes.
        unsafe { std::slice::from_raw_parts_mut(values.as_mut_ptr().cast(), N * values.len()) }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        LaneMask(I::lt(self.0, other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        LaneMask(I::le(self.0, other.0))
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        LaneMask(I::lt(other.0, self.0))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        LaneMask(I::le(other.0, self.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        LaneMask(I::eq(self.0, other.0))
    }
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().lt(Self::splat(S::INFINITY))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Lanes(I::select(mask.0, yes.0, no.0))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Lanes(I::abs(self.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes(I::sqrt(self.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Lanes(I::min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Lanes(I::max(self.0, other.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Lanes(I::copysign(self.0, sign.0))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Lanes(I::floor(self.0))
    }
    #[inline(always)]
    fn exp2_integer(self) -> Self {
        Lanes(I::exp2_integer(self.0))
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let (exponent, fraction) = I::split_exponent(self.0);
        (Lanes(exponent), Lanes(fraction))
    }

    elementary_functions!();
}

impl<S: Scalar, const N: usize, I: Registers<S, N>> LaneMask<S, N, I> {
    /// Creates a mask from one truth value per lane.
    #[inline(always)]
    pub fn from_array(values: [bool; N]) -> Self {
        let mut bits = 0;
        for (i, value) in values.into_iter().enumerate() {
            bits |= u32::from(value) << i;
        }
        LaneMask(I::mask_from_bits(bits))
    }
    /// Returns the truth value of every lane.
    #[inline(always)]
    pub fn to_array(self) -> [bool; N] {
        from_fn(|i| self.lane(i))
    }
    /// Returns the truth values, lane 0 first.
    #[inline(always)]
    pub fn iter(self) -> impl ExactSizeIterator<Item = bool> {
        self.to_array().into_iter()
    }

    /// The bits of a mask that is true everywhere.
    const FULL: u32 = u32::MAX >> (32 - N);

    #[inline(always)]
    fn bits(self) -> u32 {
        I::mask_bits(self.0)
    }
}

impl<S: Scalar, const N: usize, I: Registers<S, N>> PartialEq for LaneMask<S, N, I> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> Eq for LaneMask<S, N, I> {}
impl<S: Scalar, const N: usize, I: Registers<S, N>> fmt::Debug for LaneMask<S, N, I> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.to_array().fmt(f)
    }
}

impl<S: Scalar, const N: usize, I: Registers<S, N>> Mask for LaneMask<S, N, I> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        LaneMask(I::mask_from_bits(if value { Self::FULL } else { 0 }))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == Self::FULL
    }
    #[inline(always)]
    fn count(self) -> usize {
        self.bits().count_ones() as usize
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.bits() >> i & 1 != 0
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, value: bool) {
        let others = self.bits() & !(1 << i);
        *self = LaneMask(I::mask_from_bits(others | u32::from(value) << i));
    }
}

impl<S: Scalar, const N: usize, I: Registers<S, N>> BitAnd for LaneMask<S, N, I> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        LaneMask(I::mask_and(self.0, other.0))
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> BitOr for LaneMask<S, N, I> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        LaneMask(I::mask_or(self.0, other.0))
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> Not for LaneMask<S, N, I> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        LaneMask(I::mask_not(self.0))
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> BitAndAssign for LaneMask<S, N, I> {
    #[inline(always)]
    fn bitand_assign(&mut self, other: Self) {
        *self = *self & other;
    }
}
impl<S: Scalar, const N: usize, I: Registers<S, N>> BitOrAssign for LaneMask<S, N, I> {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}
