//! A 106-bit number type for Clarabel: `xprec`'s double-double with the traits that it lacks.

use num_traits::FloatConst;
use std::fmt;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};
use xprec::Df64;

/// A number of about 32 decimal digits, with the range of f64.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    PartialOrd,
    num_derive::Zero,
    num_derive::One,
    num_derive::ToPrimitive,
    num_derive::FromPrimitive,
    num_derive::NumCast,
    num_derive::Num,
    num_derive::Float,
)]
pub struct Wide(Df64);

impl Wide {
    pub fn to_f64(self) -> f64 {
        self.0.hi()
    }
}

pub fn wide(x: f64) -> Wide {
    Wide(Df64::new(x))
}

macro_rules! operators {
    ($($op:ident $f:ident $assign:ident $g:ident),*) => { $(
        impl $op for Wide {
            type Output = Wide;
            #[inline(always)]
            fn $f(self, other: Wide) -> Wide {
                Wide($op::$f(self.0, other.0))
            }
        }
        impl $assign for Wide {
            #[inline(always)]
            fn $g(&mut self, other: Wide) {
                *self = $op::$f(*self, other);
            }
        }
    )* };
}

operators!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign,
    Rem rem RemAssign rem_assign
);

impl Neg for Wide {
    type Output = Wide;
    #[inline(always)]
    fn neg(self) -> Wide {
        Wide(-self.0)
    }
}

impl Default for Wide {
    fn default() -> Self {
        wide(0.0)
    }
}

impl std::iter::Sum for Wide {
    fn sum<I: Iterator<Item = Wide>>(terms: I) -> Wide {
        terms.fold(Wide::default(), Add::add)
    }
}

impl fmt::Display for Wide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.to_f64(), f)
    }
}

impl fmt::LowerExp for Wide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::LowerExp::fmt(&self.to_f64(), f)
    }
}

macro_rules! constants {
    ($($name:ident)*) => {
        #[allow(non_snake_case)]
        impl FloatConst for Wide {
            $( fn $name() -> Self { Wide(<Df64 as FloatConst>::$name()) } )*
        }
    };
}

constants!(
    E FRAC_1_PI FRAC_1_SQRT_2 FRAC_2_PI FRAC_2_SQRT_PI FRAC_PI_2 FRAC_PI_3 FRAC_PI_4 FRAC_PI_6 FRAC_PI_8
    LN_10 LN_2 LOG10_E LOG2_E PI SQRT_2
);
