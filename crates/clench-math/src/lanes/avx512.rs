//! AVX-512: 8 × `f64` or 16 × `f32` in a register, truth values in a mask register.

use super::registers::Registers;
use std::arch::x86_64::*;
use std::mem::transmute;

/// AVX-512 with its doubleword, byte and vector-length extensions: every processor with AVX-512 except Knights Landing.
#[allow(unreachable_pub, reason = "one set can be part of `Scalar::SingleEnv`")]
#[derive(Clone, Copy)]
pub struct Avx512;

impl Avx512 {
    /// Returns true if the processor has all instructions that these lanes use.
    pub(crate) fn detected() -> bool {
        is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512vl")
            // The compiler takes AVX-512 to include these.
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("f16c")
    }
}

macro_rules! registers {
    (
        $scalar:ident x $lanes:literal = $vector:ident, $integer:ident, $mask:ident;
        { $($op:ident($($arg:ident),+) = $intrinsic:ident;)* }
        splat $splat:ident, and $and:ident, andnot $andnot:ident, or $or:ident, xor $xor:ident,
        floor $roundscale:ident, compare $compare:ident, blend $blend:ident,
        bits as in $layout:ident: to $to_bits:ident, from $from_bits:ident, splat $splat_bits:ident,
        add $add_bits:ident, shift $left:ident $right:ident
    ) => {
        const _: () = {
            use crate::scalar::$layout::*;

            // SAFETY: a register consists of its numbers. All intrinsics belong to the instruction set, whose presence
            // the trait requires.
            unsafe impl Registers<$scalar, $lanes> for Avx512 {
                type Vector = $vector;
                type Mask = $mask;
                const ZERO: $vector = unsafe { transmute([0.0 as $scalar; $lanes]) };
                const ONE: $vector = unsafe { transmute([1.0 as $scalar; $lanes]) };

                #[inline(always)]
                fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
                    #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl,avx2")]
                    fn run<R>(kernel: impl FnOnce() -> R) -> R {
                        kernel()
                    }
                    unsafe { run(kernel) }
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
                #[inline(always)]
                fn neg(a: $vector) -> $vector {
                    unsafe { $xor(a, $splat(-0.0)) }
                }
                #[inline(always)]
                fn abs(a: $vector) -> $vector {
                    unsafe { $andnot($splat(-0.0), a) }
                }
                #[inline(always)]
                fn copysign(a: $vector, sign: $vector) -> $vector {
                    unsafe {
                        let bit = $splat(-0.0);
                        $or($andnot(bit, a), $and(bit, sign))
                    }
                }
                #[inline(always)]
                fn floor(a: $vector) -> $vector {
                    unsafe { $roundscale::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a) }
                }

                #[inline(always)]
                fn exp2_integer(a: $vector) -> $vector {
                    unsafe {
                        let integers = $to_bits(<Self as Registers<$scalar, $lanes>>::add(a, $splat(INTEGERS)));
                        $from_bits($left::<FRACTION>($add_bits(integers, $splat_bits(BIAS as $integer))))
                    }
                }
                #[inline(always)]
                fn split_exponent(a: $vector) -> ($vector, $vector) {
                    unsafe {
                        let moved = $add_bits($to_bits(a), $splat_bits(TO_ROOT_HALF as $integer));
                        let exponent = $add_bits($right::<FRACTION>(moved), $to_bits($splat(INTEGERS)));
                        let fraction = _mm512_and_si512(moved, $splat_bits(FRACTION_MASK as $integer));
                        let mantissa = $add_bits(fraction, $splat_bits(ROOT_HALF as $integer));
                        let excess = $splat(BIASED_INTEGERS);
                        let exponent = <Self as Registers<$scalar, $lanes>>::sub($from_bits(exponent), excess);
                        (exponent, $from_bits(mantissa))
                    }
                }

                #[inline(always)]
                fn lt(a: $vector, b: $vector) -> $mask {
                    unsafe { $compare::<_CMP_LT_OQ>(a, b) }
                }
                #[inline(always)]
                fn le(a: $vector, b: $vector) -> $mask {
                    unsafe { $compare::<_CMP_LE_OQ>(a, b) }
                }
                #[inline(always)]
                fn eq(a: $vector, b: $vector) -> $mask {
                    unsafe { $compare::<_CMP_EQ_OQ>(a, b) }
                }
                #[inline(always)]
                fn select(mask: $mask, yes: $vector, no: $vector) -> $vector {
                    unsafe { $blend(mask, no, yes) }
                }

                #[inline(always)]
                fn mask_bits(mask: $mask) -> u32 {
                    u32::from(mask)
                }
                #[inline(always)]
                fn mask_from_bits(bits: u32) -> $mask {
                    bits as $mask
                }
                #[inline(always)]
                fn mask_and(a: $mask, b: $mask) -> $mask {
                    a & b
                }
                #[inline(always)]
                fn mask_or(a: $mask, b: $mask) -> $mask {
                    a | b
                }
                #[inline(always)]
                fn mask_not(mask: $mask) -> $mask {
                    !mask
                }
            }
        };
    };
}

registers! {
    f64 x 8 = __m512d, i64, __mmask8;
    {
        add(a, b) = _mm512_add_pd;
        sub(a, b) = _mm512_sub_pd;
        mul(a, b) = _mm512_mul_pd;
        div(a, b) = _mm512_div_pd;
        min(a, b) = _mm512_min_pd;
        max(a, b) = _mm512_max_pd;
        sqrt(a) = _mm512_sqrt_pd;
    }
    splat _mm512_set1_pd, and _mm512_and_pd, andnot _mm512_andnot_pd, or _mm512_or_pd, xor _mm512_xor_pd,
    floor _mm512_roundscale_pd, compare _mm512_cmp_pd_mask, blend _mm512_mask_blend_pd,
    bits as in double: to _mm512_castpd_si512, from _mm512_castsi512_pd, splat _mm512_set1_epi64,
    add _mm512_add_epi64, shift _mm512_slli_epi64 _mm512_srli_epi64
}
registers! {
    f32 x 16 = __m512, i32, __mmask16;
    {
        add(a, b) = _mm512_add_ps;
        sub(a, b) = _mm512_sub_ps;
        mul(a, b) = _mm512_mul_ps;
        div(a, b) = _mm512_div_ps;
        min(a, b) = _mm512_min_ps;
        max(a, b) = _mm512_max_ps;
        sqrt(a) = _mm512_sqrt_ps;
    }
    splat _mm512_set1_ps, and _mm512_and_ps, andnot _mm512_andnot_ps, or _mm512_or_ps, xor _mm512_xor_ps,
    floor _mm512_roundscale_ps, compare _mm512_cmp_ps_mask, blend _mm512_mask_blend_ps,
    bits as in single: to _mm512_castps_si512, from _mm512_castsi512_ps, splat _mm512_set1_epi32,
    add _mm512_add_epi32, shift _mm512_slli_epi32 _mm512_srli_epi32
}
