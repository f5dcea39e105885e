//! `Real` for one environment: `f64` and `f32`.

use crate::elementary::elementary_functions;
use crate::lanes::dispatch as lanes;
use crate::real::{Real, Scalar};
use crate::{Instructions, LaneTask};

macro_rules! scalar {
    ($t:ident, $bits:ident, $layout:ident, $alone:ty, $instructions:expr) => {
        /// The bit layout of a number.
        pub(crate) mod $layout {
            /// The number of bits of the fraction.
            pub(crate) const FRACTION: u32 = $t::MANTISSA_DIGITS - 1;
            /// The mask of the fraction.
            pub(crate) const FRACTION_MASK: $bits = (1 << FRACTION) - 1;
            /// The bias of a stored exponent.
            pub(crate) const BIAS: $bits = $t::MAX_EXP as $bits - 1;
            /// 1.5 × 2^FRACTION. Added to a small integer, it leaves that integer in the low bits of the fraction.
            pub(crate) const INTEGERS: $t = ((3 as $bits) << (FRACTION - 1)) as $t;
            /// The same plus the bias of a stored exponent.
            pub(crate) const BIASED_INTEGERS: $t = INTEGERS + BIAS as $t;
            /// √½.
            pub(crate) const ROOT_HALF: $bits = (std::f64::consts::FRAC_1_SQRT_2 as $t).to_bits();
            /// Added to the bits of a number, it roughly multiplies it by √2: the exponent then steps at √½ · 2ᵏ, and
            /// the fraction is 0 there.
            pub(crate) const TO_ROOT_HALF: $bits = (1 as $t).to_bits() - ROOT_HALF;
        }
        const _: () = {
            use $layout::*;

            impl Real for $t {
                type Scalar = $t;
                type Value = $t;
                type Mask = bool;
                type Clock = f64;
                const LANES: usize = 1;
                const ZERO: $t = 0.0;
                const ONE: $t = 1.0;

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
                    // One copy per kernel: inlined kernels made scalar code three times as large, and slower.
                    #[inline(never)]
                    fn run<R>(kernel: impl FnOnce() -> R) -> R {
                        kernel()
                    }
                    run(kernel)
                }
                #[inline(always)]
                fn vectorize_rows<R>(kernel: impl FnOnce() -> R) -> R {
                    lanes::in_widest(kernel)
                }
                #[inline(always)]
                fn as_scalars(values: &[$t]) -> &[$t] {
                    values
                }
                #[inline(always)]
                fn as_scalars_mut(values: &mut [$t]) -> &mut [$t] {
                    values
                }
                #[inline(always)]
                fn new(value: f64) -> $t {
                    value as $t
                }
                #[inline(always)]
                fn splat(value: $t) -> $t {
                    value
                }
                #[inline(always)]
                fn lane(self, _: usize) -> $t {
                    self
                }
                #[inline(always)]
                fn set_lane(&mut self, _: usize, value: $t) {
                    *self = value;
                }
                #[inline(always)]
                fn lt(self, other: $t) -> bool {
                    self < other
                }
                #[inline(always)]
                fn le(self, other: $t) -> bool {
                    self <= other
                }
                #[inline(always)]
                fn gt(self, other: $t) -> bool {
                    self > other
                }
                #[inline(always)]
                fn ge(self, other: $t) -> bool {
                    self >= other
                }
                #[inline(always)]
                fn eq(self, other: $t) -> bool {
                    self == other
                }
                #[inline(always)]
                fn is_finite(self) -> bool {
                    $t::is_finite(self)
                }
                #[inline(always)]
                fn select(mask: bool, yes: $t, no: $t) -> $t {
                    if mask { yes } else { no }
                }
                #[inline(always)]
                fn abs(self) -> $t {
                    $t::abs(self)
                }
                #[inline(always)]
                fn sqrt(self) -> $t {
                    $t::sqrt(self)
                }
                #[inline(always)]
                fn min(self, other: $t) -> $t {
                    if self < other { self } else { other }
                }
                #[inline(always)]
                fn max(self, other: $t) -> $t {
                    if self > other { self } else { other }
                }
                #[inline(always)]
                fn copysign(self, sign: $t) -> $t {
                    $t::copysign(self, sign)
                }
                #[inline(always)]
                fn floor(self) -> $t {
                    $t::floor(self)
                }
                #[inline(always)]
                fn exp2_integer(self) -> $t {
                    $t::from_bits((self + INTEGERS).to_bits().wrapping_add(BIAS) << FRACTION)
                }
                #[inline(always)]
                fn split_exponent(self) -> ($t, $t) {
                    let moved = self.to_bits().wrapping_add(TO_ROOT_HALF);
                    let exponent = $t::from_bits(INTEGERS.to_bits() + (moved >> FRACTION));
                    let mantissa = $t::from_bits((moved & FRACTION_MASK) + ROOT_HALF);
                    (exponent - BIASED_INTEGERS, mantissa)
                }

                elementary_functions!();
            }

            impl Scalar for $t {
                type SingleEnv = $alone;
                type Double = f64;
                const SINGLE_ENV: Instructions = $instructions;
                const EPSILON: $t = $t::EPSILON;
                const INFINITY: $t = $t::INFINITY;
                const MAX: $t = $t::MAX;
                const MIN_POSITIVE: $t = $t::MIN_POSITIVE;
                const DIGITS: u32 = $t::MANTISSA_DIGITS;
                #[inline(always)]
                fn to_f64(self) -> f64 {
                    self as f64
                }
                #[inline(always)]
                fn to_double(self) -> f64 {
                    self as f64
                }
                #[inline(always)]
                fn from_double(value: f64) -> $t {
                    value as $t
                }
                #[inline(never)]
                fn all_within(values: &[$t], limit: $t) -> bool {
                    let mut within = true;
                    for x in values {
                        within &= x.abs() <= limit;
                    }
                    within
                }
                #[inline(always)]
                fn in_lanes<K: LaneTask<$t>>(
                    instructions: Instructions,
                    task: K,
                ) -> Option<K::Output> {
                    lanes::$t(instructions, task)
                }
            }
        };
    };
}

scalar!(f64, u64, double, f64, Instructions::Scalar);
scalar!(f32, u32, single, lanes::Single, lanes::SINGLE);
