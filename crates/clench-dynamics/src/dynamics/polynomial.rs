//! Springs and dampers whose force is a polynomial (MuJoCo 4.0, *Computation*, "Polynomial forces").
//!
//! ```text
//! spring at the displacement x:   f = −(a x + b x² + c x³)      energy  ½ a x² + ⅓ b x³ + ¼ c x⁴     −∂f/∂x = a + 2 b x + 3 c x²
//! damper at the velocity v:       f = −(a v + b v |v| + c v³)   −∂f/∂v = a + 2 b |v| + 3 c v²
//! ```
//!
//! A damper's force is odd in v, a spring's need not be. A spatial displacement, of a ball or free joint, has a length
//! x ≥ 0, and the force is along it.

use clench_math::{Mask, Real};

/// The coefficients a, and [b, c].
#[derive(Clone, Copy, Debug)]
pub struct Polynomial<T> {
    /// The coefficient of the first power.
    pub linear: T,
    /// The coefficients of the second and third power.
    pub higher: [T; 2],
}

impl<T: Real> Polynomial<T> {
    /// Creates a polynomial of these coefficients.
    #[inline(always)]
    pub fn new(linear: T, higher: [T; 2]) -> Self {
        Polynomial { linear, higher }
    }

    /// Returns true if the force is zero in all lanes.
    #[inline(always)]
    pub fn is_zero(&self) -> bool {
        (self.linear.eq(T::ZERO) & !self.is_curved()).all()
    }

    /// Returns the lanes with a coefficient of a higher power.
    #[inline(always)]
    pub(crate) fn is_curved(&self) -> T::Mask {
        let [b, c] = self.higher;
        !(b.eq(T::ZERO) & c.eq(T::ZERO))
    }

    /// Returns minus a spring's force over its displacement `x`: a + b x + c x².
    #[inline(always)]
    pub fn stiffness(&self, x: T) -> T {
        let [b, c] = self.higher;
        self.linear + x * (b + x * c)
    }

    /// Returns minus the derivative of a spring's force by its displacement `x`: a + 2 b x + 3 c x².
    #[inline(always)]
    pub fn stiffness_slope(&self, x: T) -> T {
        let [b, c] = self.higher;
        self.linear + x * (T::new(2.0) * b + x * (T::new(3.0) * c))
    }

    /// Returns the energy of a spring of displacement `x`.
    #[inline(always)]
    pub fn energy(&self, x: T) -> T {
        let [b, c] = self.higher;
        let mean = self.linear * T::new(0.5) + x * (b * T::new(1.0 / 3.0) + x * c * T::new(0.25));
        mean * x.squared()
    }

    /// Returns minus a damper's force over its velocity `v`: a + b |v| + c v².
    #[inline(always)]
    pub fn damping(&self, v: T) -> T {
        self.stiffness(v.abs())
    }

    /// Returns minus the derivative of a damper's force by its velocity `v`: a + 2 b |v| + 3 c v².
    #[inline(always)]
    pub fn damping_slope(&self, v: T) -> T {
        self.stiffness_slope(v.abs())
    }
}
