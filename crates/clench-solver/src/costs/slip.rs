//! The slip of a contact: its tangential rows, scaled so that the limit of friction becomes circular.
//!
//! ```text
//! U_j = μ_j y_j,   T = |U|,   u = U / T
//! ```

use super::block_cost::MAX_DIM;
use clench_math::Real;

/// The slip at one y.
#[derive(Clone, Copy)]
pub(super) struct Slip<T> {
    /// T.
    pub t: T,
    /// 1 / T, or 1 without slip.
    pub inverse: T,
    /// The direction of slip, zero without slip. Row 0 is unused.
    pub u: [T; MAX_DIM],
}

impl<T: Real> Slip<T> {
    /// Computes the slip from the coefficients and the rows; those of the normal are not read.
    #[inline(always)]
    pub(super) fn new(shape: &[T], y: impl Fn(usize) -> T) -> Self {
        let dim = shape.len();
        let mut u = [T::ZERO; MAX_DIM];
        let mut t2 = T::ZERO;
        for j in 1..dim {
            u[j] = shape[j] * y(j);
            t2 += u[j] * u[j];
        }
        let t = t2.sqrt();
        let inverse = T::ONE / T::select(t.gt(T::ZERO), t, T::ONE);
        for u in &mut u[1..dim] {
            *u *= inverse;
        }
        Slip { t, inverse, u }
    }
}

/// The slip along a ray, from y to y + α dy. U' is the derivative of U by α.
pub(super) struct SlipPath<T> {
    /// |U'|².
    pub squares: T,
    /// u₀·U'.
    pub along: T,
    /// The growth of u·U'.
    pub turn: T,
    /// T₁ − T₀ − α u₀·U' ≥ 0.
    pub bend: T,
}

impl<T: Real> SlipPath<T> {
    /// Computes the differences in a form that avoids cancellation for small steps.
    #[inline(always)]
    pub(super) fn new(
        shape: &[T],
        dy: &[T],
        alpha: T,
        [before, after]: [&Slip<T>; 2],
    ) -> SlipPath<T> {
        let (mut along, mut squares) = (T::ZERO, T::ZERO);
        for j in 1..shape.len() {
            let du = shape[j] * dy[j];
            along += before.u[j] * du;
            squares += du * du;
        }
        // T₁² = (T₀ + α u₀·U')² + α² (|U'|² − (u₀·U')²). The bend is the height of T₁ above its tangent T₀ + α u₀·U'.
        let across = (squares - along * along).max(T::ZERO);
        let straight = before.t + alpha * along;
        let ahead = straight.gt(T::ZERO);
        let sum = T::select(ahead, after.t + straight, T::ONE);
        let bend = T::select(ahead, alpha * alpha * across / sum, after.t - straight);
        let slips = after.t.gt(T::ZERO);
        let turn = (alpha * across - along * bend) / T::select(slips, after.t, T::ONE);
        SlipPath {
            squares,
            along,
            turn: T::select(slips, turn, -along),
            bend,
        }
    }
}
