//! Limits and frictionless contacts: only pushing costs, and only y < 0 pushes.
//!
//! With m = min(y, 0):
//!
//! ```text
//! s(y) = ½ Σ D m²      force = −D m ≥ 0      Hessian = diag(D where y < 0)      pieces: 1 where y < 0, else 0
//! s(y₁) − s(y₀) = ½ Σ D (m₁ − m₀)(m₁ + m₀)
//! ```

use super::block_cost::{BlockCost, Form, RankOne, Rows, Slope, Totals, Weight};
use clench_math::{Mask, Real};

pub(crate) struct OneSided;

impl<T: Real> BlockCost<T> for OneSided {
    #[inline(always)]
    fn active_len(dim: usize) -> usize {
        dim
    }

    #[inline(always)]
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    ) {
        for i in 0..rows.d.len() {
            let d = rows.d[i];
            let m = y[i].min(T::ZERO);
            force[i] = -(d * m);
            totals.cost += T::new(0.5) * d * m * m;
            totals.mark(&mut active_set[i], active(d, y[i]));
        }
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, _: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form {
        let mut any = T::Mask::splat(false);
        for (i, (&d, &piece)) in rows.d.iter().zip(active_set).enumerate() {
            weight[i][i] = d * piece;
            any |= piece.gt(T::ZERO);
        }
        Form::diagonal_if(any.any())
    }

    #[inline(always)]
    fn changes(rows: Rows<T>, old: &[T], new: &[T], mut emit: impl FnMut(RankOne<T>)) {
        for row in 0..rows.d.len() {
            emit(RankOne {
                sigma: rows.d[row] * (new[row] - old[row]),
                row,
                side: None,
            });
        }
    }

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        for ((&d, &y), &dy) in rows.d.iter().zip(y).zip(dy) {
            add_edge_slope(d, y + alpha * dy, dy, slope);
        }
    }

    #[inline(always)]
    fn change(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let mut sum = T::ZERO;
        for ((&d, &y), &dy) in rows.d.iter().zip(y).zip(dy) {
            sum += edge_change(d, y, alpha * dy);
        }
        sum
    }
}

/// 1 where the constraint exists and is violated, else 0.
#[inline(always)]
pub(super) fn active<T: Real>(d: T, y: T) -> T {
    T::select(d.gt(T::ZERO) & y.lt(T::ZERO), T::ONE, T::ZERO)
}

/// Adds the derivatives of one one-sided term at `y`, moving by `dy`.
#[inline(always)]
pub(super) fn add_edge_slope<T: Real>(d: T, y: T, dy: T, slope: &mut Slope<T>) {
    let stiffness = T::select(y.lt(T::ZERO), d, T::ZERO) * dy;
    slope.first += stiffness * y;
    slope.second += stiffness * dy;
}

/// s(y + step) − s(y) of one one-sided term.
#[inline(always)]
pub(super) fn edge_change<T: Real>(d: T, y: T, step: T) -> T {
    let (m0, m1) = (y.min(T::ZERO), (y + step).min(T::ZERO));
    // m₁ − m₀ is the step itself where both are violated: it keeps all its digits.
    let dm = T::select(y.lt(T::ZERO) & (y + step).lt(T::ZERO), step, m1 - m0);
    T::new(0.5) * d * dm * (m1 + m0)
}
