//! AVX2: 4 × `f64` or 8 × `f32` in a register; a truth value is a lane of ones or zeros.

use super::registers::Registers;
use std::arch::x86_64::*;
use std::mem::transmute;

/// AVX and AVX2.
#[allow(unreachable_pub, reason = "one set can be part of `Scalar::SingleEnv`")]
#[derive(Clone, Copy)]
pub struct Avx2;

impl Avx2 {
    /// Returns true if the processor has all instructions that these lanes use.
    pub(crate) fn detected() -> bool {
        is_x86_feature_detected!("avx2")
    }
}

macro_rules! registers {
    (
        $scalar:ident x $lanes:literal = $vector:ident, $integer:ident;
        { $($op:ident($($arg:ident),+) = $intrinsic:ident;)* }
        splat $splat:ident, and $and:ident, andnot $andnot:ident, or $or:ident, xor $xor:ident,
        floor $round:ident, compare $compare:ident, blend $blend:ident, signs $signs:ident,
        bits as in $layout:ident: to $to_bits:ident, from $from_bits:ident, splat $splat_bits:ident,
        add $add_bits:ident, shift $left:ident $right:ident
    ) => {
        const _: () = {
            use crate::scalar::$layout::*;

            // SAFETY: a register consists of its numbers. All intrinsics belong to the instruction set, whose presence
            // the trait requires.
            unsafe impl Registers<$scalar, $lanes> for Avx2 {
                type Vector = $vector;
                type Mask = $vector;
                const ZERO: $vector = unsafe { transmute([0.0 as $scalar; $lanes]) };
                const ONE: $vector = unsafe { transmute([1.0 as $scalar; $lanes]) };

                #[inline(always)]
                fn vectorize<R>(kernel: impl FnOnce() -> R) -> R {
                    #[target_feature(enable = "avx2")]
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
                    unsafe { $round::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a) }
                }

                #[inline(always)]
                fn exp2_integer(a: $vector) -> $vector {
                    unsafe {
                        let integers = $to_bits(<Self as Registers<$scalar, $lanes>>::add(a, $splat(INTEGERS)));
                        $from_bits($left::<{ FRACTION as i32 }>($add_bits(integers, $splat_bits(BIAS as $integer))))
                    }
                }
                #[inline(always)]
                fn split_exponent(a: $vector) -> ($vector, $vector) {
                    unsafe {
                        let moved = $add_bits($to_bits(a), $splat_bits(TO_ROOT_HALF as $integer));
                        let exponent = $add_bits($right::<{ FRACTION as i32 }>(moved), $to_bits($splat(INTEGERS)));
                        let fraction = _mm256_and_si256(moved, $splat_bits(FRACTION_MASK as $integer));
                        let mantissa = $add_bits(fraction, $splat_bits(ROOT_HALF as $integer));
                        let excess = $splat(BIASED_INTEGERS);
                        let exponent = <Self as Registers<$scalar, $lanes>>::sub($from_bits(exponent), excess);
                        (exponent, $from_bits(mantissa))
                    }
                }

                #[inline(always)]
                fn lt(a: $vector, b: $vector) -> $vector {
                    unsafe { $compare::<_CMP_LT_OQ>(a, b) }
                }
                #[inline(always)]
                fn le(a: $vector, b: $vector) -> $vector {
                    unsafe { $compare::<_CMP_LE_OQ>(a, b) }
                }
                #[inline(always)]
                fn eq(a: $vector, b: $vector) -> $vector {
                    unsafe { $compare::<_CMP_EQ_OQ>(a, b) }
                }
                #[inline(always)]
                fn select(mask: $vector, yes: $vector, no: $vector) -> $vector {
                    unsafe { $blend(no, yes, mask) }
                }

                #[inline(always)]
                fn mask_bits(mask: $vector) -> u32 {
                    unsafe { $signs(mask) as u32 }
                }
                #[inline(always)]
                fn mask_from_bits(bits: u32) -> $vector {
                    let mut lanes = [0 as $integer; $lanes];
                    for (i, lane) in lanes.iter_mut().enumerate() {
                        *lane = -((bits >> i & 1) as $integer);
                    }
                    unsafe { transmute(lanes) }
                }
                #[inline(always)]
                fn mask_and(a: $vector, b: $vector) -> $vector {
                    unsafe { $and(a, b) }
                }
                #[inline(always)]
                fn mask_or(a: $vector, b: $vector) -> $vector {
                    unsafe { $or(a, b) }
                }
                #[inline(always)]
                fn mask_not(mask: $vector) -> $vector {
                    unsafe { $xor(mask, transmute::<[$integer; $lanes], $vector>([-1; $lanes])) }
                }
            }
        };
    };
}

registers! {
    f64 x 4 = __m256d, i64;
    {
        add(a, b) = _mm256_add_pd;
        sub(a, b) = _mm256_sub_pd;
        mul(a, b) = _mm256_mul_pd;
        div(a, b) = _mm256_div_pd;
        min(a, b) = _mm256_min_pd;
        max(a, b) = _mm256_max_pd;
        sqrt(a) = _mm256_sqrt_pd;
    }
    splat _mm256_set1_pd, and _mm256_and_pd, andnot _mm256_andnot_pd, or _mm256_or_pd, xor _mm256_xor_pd,
    floor _mm256_round_pd, compare _mm256_cmp_pd, blend _mm256_blendv_pd, signs _mm256_movemask_pd,
    bits as in double: to _mm256_castpd_si256, from _mm256_castsi256_pd, splat _mm256_set1_epi64x,
    add _mm256_add_epi64, shift _mm256_slli_epi64 _mm256_srli_epi64
}
registers! {
    f32 x 8 = __m256, i32;
    {
        add(a, b) = _mm256_add_ps;
        sub(a, b) = _mm256_sub_ps;
        mul(a, b) = _mm256_mul_ps;
        div(a, b) = _mm256_div_ps;
        min(a, b) = _mm256_min_ps;
        max(a, b) = _mm256_max_ps;
        sqrt(a) = _mm256_sqrt_ps;
    }
    splat _mm256_set1_ps, and _mm256_and_ps, andnot _mm256_andnot_ps, or _mm256_or_ps, xor _mm256_xor_ps,
    floor _mm256_round_ps, compare _mm256_cmp_ps, blend _mm256_blendv_ps, signs _mm256_movemask_ps,
    bits as in single: to _mm256_castps_si256, from _mm256_castsi256_ps, splat _mm256_set1_epi32,
    add _mm256_add_epi32, shift _mm256_slli_epi32 _mm256_srli_epi32
}
