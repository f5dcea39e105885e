//! Limits and frictionless contacts: the cost is nonzero only for y < 0, and the force only pushes.
//!
//! With m = min(y, 0):
//!
//! ```text
//! s(y) = ½ Σ D m²      force = −D m ≥ 0      Hessian = diag(D where y < 0)      pieces: 1 where y < 0, else 0
//! s(y₁) − s(y₀) − ∇s(y₀)·(y₁ − y₀) = Σ D (m₁ − m₀)² / 2 + D m₀ ((m₁ − m₀) − (y₁ − y₀))
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
            add_edge_slope(d, y, dy, alpha, slope);
        }
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let mut sum = T::ZERO;
        for ((&d, &y), &dy) in rows.d.iter().zip(y).zip(dy) {
            sum += edge_divergence(d, y, alpha * dy);
        }
        sum
    }
}

/// Returns 1 if the constraint exists and is violated, else 0.
#[inline(always)]
pub(super) fn active<T: Real>(d: T, y: T) -> T {
    T::select(d.gt(T::ZERO) & y.lt(T::ZERO), T::ONE, T::ZERO)
}

/// Returns the change of min(y, 0) when y changes by `step`. If both ends are violated it is the step itself, without
/// cancellation.
#[inline(always)]
fn violation_change<T: Real>(y: T, step: T) -> T {
    let end = y + step;
    let both = y.lt(T::ZERO) & end.lt(T::ZERO);
    T::select(both, step, end.min(T::ZERO) - y.min(T::ZERO))
}

/// Adds to the slope the contribution of one one-sided term that starts at `y` and moves by `alpha` times `dy`.
#[inline(always)]
pub(super) fn add_edge_slope<T: Real>(d: T, y: T, dy: T, alpha: T, slope: &mut Slope<T>) {
    let step = alpha * dy;
    slope.growth += d * dy * violation_change(y, step);
    slope.second += T::select((y + step).lt(T::ZERO), d, T::ZERO) * dy * dy;
}

/// Computes s(y + step) − s(y) − s'(y) step of one one-sided term.
#[inline(always)]
pub(super) fn edge_divergence<T: Real>(d: T, y: T, step: T) -> T {
    let change = violation_change(y, step);
    d * (T::new(0.5) * change * change + y.min(T::ZERO) * (change - step))
}
