//! NEON: 2 × `f64` or 4 × `f32` in a register; a truth value is a lane of ones or zeros.
//!
//! Every 64-bit ARM processor has it, so there is no detection, and kernels are always compiled for it.

use super::registers::Registers;
use std::arch::aarch64::*;
use std::mem::transmute;

/// Advanced SIMD.
#[allow(unreachable_pub, reason = "one set can be part of `Scalar::SingleEnv`")]
#[derive(Clone, Copy)]
pub struct Neon;

macro_rules! registers {
    (
        $scalar:ident x $lanes:literal = $vector:ident, $integer:ident in $integers:ident, bit of lane $bit_of_lane:expr;
        { $($op:ident($($arg:ident),+) = $intrinsic:ident;)* }
        splat $splat:ident, blend $blend:ident,
        lt $lt:ident, le $le:ident, eq $eq:ident,
        bits as in $layout:ident: to $to_bits:ident, from $from_bits:ident, splat $splat_bits:ident,
        add $add_bits:ident, sum $sum_bits:ident, shift $left:ident $right:ident,
        and $and:ident, or $or:ident, xor $xor:ident, test $test:ident
    ) => {
        const _: () = {
            use crate::scalar::$layout::*;

            /// Bit `i` in lane `i`.
            const BIT_OF_LANE: $integers = unsafe { transmute::<[$integer; $lanes], _>($bit_of_lane) };

            // SAFETY: a register consists of its numbers. All intrinsics belong to the instruction set, which every
            // such processor has.
            unsafe impl Registers<$scalar, $lanes> for Neon {
                type Vector = $vector;
                type Mask = $integers;
                const ZERO: $vector = unsafe { transmute([0.0 as $scalar; $lanes]) };
                const ONE: $vector = unsafe { transmute([1.0 as $scalar; $lanes]) };

                #[inline(always)]
                fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
                    kernel()
                }

                #[inline(always)]
                fn from_array(values: [$scalar; $lanes]) -> $vector {
                    unsafe { transmute(values) }
                }
                #[inline(always)]
                fn to_array(v: $vector) -> [$scalar; $lanes] {
                    unsafe { transmute(v) }
                }
                #[inline(always)]
                fn splat(value: $scalar) -> $vector {
                    unsafe { $splat(value) }
                }

                $(
                    #[inline(always)]
                    fn $op($($arg: $vector),+) -> $vector {
                        unsafe { $intrinsic($($arg),+) }
                    }
                )*
                // NEON's own minimum and maximum return NaN if either operand is NaN, and order the zeros.
                #[inline(always)]
                fn min(a: $vector, b: $vector) -> $vector {
                    unsafe { $blend($lt(a, b), a, b) }
                }
                #[inline(always)]
                fn max(a: $vector, b: $vector) -> $vector {
                    unsafe { $blend($lt(b, a), a, b) }
                }
                #[inline(always)]
                fn copysign(a: $vector, sign: $vector) -> $vector {
                    unsafe { $blend($to_bits($splat(-0.0)), sign, a) }
                }

                #[inline(always)]
                fn exp2_integer(a: $vector) -> $vector {
                    unsafe {
                        let integers = $to_bits(<Self as Registers<$scalar, $lanes>>::add(a, $splat(INTEGERS)));
                        $from_bits($left::<{ FRACTION as i32 }>($add_bits(integers, $splat_bits(BIAS))))
                    }
                }
                #[inline(always)]
                fn split_exponent(a: $vector) -> ($vector, $vector) {
                    unsafe {
                        let moved = $add_bits($to_bits(a), $splat_bits(TO_ROOT_HALF));
                        let exponent = $add_bits($right::<{ FRACTION as i32 }>(moved), $to_bits($splat(INTEGERS)));
                        let fraction = $and(moved, $splat_bits(FRACTION_MASK));
                        let mantissa = $add_bits(fraction, $splat_bits(ROOT_HALF));
                        let excess = $splat(BIASED_INTEGERS);
                        let exponent = <Self as Registers<$scalar, $lanes>>::sub($from_bits(exponent), excess);
                        (exponent, $from_bits(mantissa))
                    }
                }

                #[inline(always)]
                fn lt(a: $vector, b: $vector) -> $integers {
                    unsafe { $lt(a, b) }
                }
                #[inline(always)]
                fn le(a: $vector, b: $vector) -> $integers {
                    unsafe { $le(a, b) }
                }
                #[inline(always)]
                fn eq(a: $vector, b: $vector) -> $integers {
                    unsafe { $eq(a, b) }
                }
                #[inline(always)]
                fn select(mask: $integers, yes: $vector, no: $vector) -> $vector {
                    unsafe { $blend(mask, yes, no) }
                }

                #[inline(always)]
                fn mask_bits(mask: $integers) -> u32 {
                    unsafe { $sum_bits($and(mask, BIT_OF_LANE)) as u32 }
                }
                #[inline(always)]
                fn mask_from_bits(bits: u32) -> $integers {
                    unsafe { $test($splat_bits(bits as $integer), BIT_OF_LANE) }
                }
                #[inline(always)]
                fn mask_and(a: $integers, b: $integers) -> $integers {
                    unsafe { $and(a, b) }
                }
                #[inline(always)]
                fn mask_or(a: $integers, b: $integers) -> $integers {
                    unsafe { $or(a, b) }
                }
                #[inline(always)]
                fn mask_not(mask: $integers) -> $integers {
                    unsafe { $xor(mask, $splat_bits($integer::MAX)) }
                }
            }
        };
    };
}

registers! {
    f64 x 2 = float64x2_t, u64 in uint64x2_t, bit of lane [1, 2];
    {
        add(a, b) = vaddq_f64;
        sub(a, b) = vsubq_f64;
        mul(a, b) = vmulq_f64;
        div(a, b) = vdivq_f64;
        neg(a) = vnegq_f64;
        abs(a) = vabsq_f64;
        sqrt(a) = vsqrtq_f64;
        floor(a) = vrndmq_f64;
    }
    splat vdupq_n_f64, blend vbslq_f64,
    lt vcltq_f64, le vcleq_f64, eq vceqq_f64,
    bits as in double: to vreinterpretq_u64_f64, from vreinterpretq_f64_u64, splat vdupq_n_u64,
    add vaddq_u64, sum vaddvq_u64, shift vshlq_n_u64 vshrq_n_u64,
    and vandq_u64, or vorrq_u64, xor veorq_u64, test vtstq_u64
}
registers! {
    f32 x 4 = float32x4_t, u32 in uint32x4_t, bit of lane [1, 2, 4, 8];
    {
        add(a, b) = vaddq_f32;
        sub(a, b) = vsubq_f32;
        mul(a, b) = vmulq_f32;
        div(a, b) = vdivq_f32;
        neg(a) = vnegq_f32;
        abs(a) = vabsq_f32;
        sqrt(a) = vsqrtq_f32;
        floor(a) = vrndmq_f32;
    }
    splat vdupq_n_f32, blend vbslq_f32,
    lt vcltq_f32, le vcleq_f32, eq vceqq_f32,
    bits as in single: to vreinterpretq_u32_f32, from vreinterpretq_f32_u32, splat vdupq_n_u32,
    add vaddq_u32, sum vaddvq_u32, shift vshlq_n_u32 vshrq_n_u32,
    and vandq_u32, or vorrq_u32, xor veorq_u32, test vtstq_u32
}
