//! `Real` for one environment: `f64` and `f32`.

use crate::real::{Real, Scalar};

macro_rules! scalar {
    ($t:ident) => {
        impl Real for $t {
            type Scalar = $t;
            type Mask = bool;
            const LANES: usize = 1;
            const ZERO: $t = 0.0;
            const ONE: $t = 1.0;

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
            fn sin_cos(self) -> ($t, $t) {
                $t::sin_cos(self)
            }
            fn atan2(self, x: $t) -> $t {
                $t::atan2(self, x)
            }
            fn exp(self) -> $t {
                $t::exp(self)
            }
            fn ln(self) -> $t {
                $t::ln(self)
            }
            fn powf(self, exponent: $t) -> $t {
                $t::powf(self, exponent)
            }
        }

        impl Scalar for $t {
            const EPSILON: $t = $t::EPSILON;
            const INFINITY: $t = $t::INFINITY;
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
        }
    };
}

scalar!(f64);
scalar!(f32);
