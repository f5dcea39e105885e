//! Dry friction of loss η: quadratic, then linear once the force reaches η.
//!
//! With c = clamp(y, −Rη, Rη):
//!
//! ```text
//! s(y) = ½ D y² where |y| < Rη, else η |y| − ½ R η²      force = −D y, saturated at ±η
//! Hessian = diag(D where |y| < Rη)                       pieces: −1, 0, 1 for y ≤ −Rη, between, y ≥ Rη
//! s(y₁) − s(y₀) − ∇s(y₀)·(y₁ − y₀) = D (c₁ − c₀)(y₁ − ½ (c₀ + c₁))      as s = D (c y − ½ c²)
//! ```

use super::block_cost::{BlockCost, Form, RankOne, Rows, Slope, Totals, Weight};
use clench_math::{Mask, Real};

pub(crate) struct Huber;

impl<T: Real> BlockCost<T> for Huber {
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
            let (d, y, eta) = (rows.d[i], y[i], rows.shape[i]);
            let side = side(rows.r[i] * eta, y);
            let inside = side.eq(T::ZERO);
            let exists = d.gt(T::ZERO);
            let saturated = -(side * eta);
            force[i] = T::select(exists, T::select(inside, -(d * y), saturated), T::ZERO);
            let quadratic = T::new(0.5) * d * y * y;
            let linear = eta * (y.abs() - T::new(0.5) * rows.r[i] * eta);
            totals.cost += T::select(exists, T::select(inside, quadratic, linear), T::ZERO);
            totals.mark(&mut active_set[i], T::select(exists, side, T::ZERO));
        }
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, _: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form {
        let mut any = T::Mask::splat(false);
        for (i, (&d, &piece)) in rows.d.iter().zip(active_set).enumerate() {
            let inside = piece.eq(T::ZERO) & d.gt(T::ZERO);
            weight[i][i] = T::select(inside, d, T::ZERO);
            any |= inside;
        }
        Form::diagonal_if(any.any())
    }

    #[inline(always)]
    fn changes(rows: Rows<T>, old: &[T], new: &[T], mut emit: impl FnMut(RankOne<T>)) {
        for row in 0..rows.d.len() {
            // |piece| is 1 where the row is saturated and has no curvature.
            emit(RankOne {
                sigma: rows.d[row] * (old[row].abs() - new[row].abs()),
                row,
                side: None,
            });
        }
    }

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        for i in 0..rows.d.len() {
            let (d, dy) = (rows.d[i], dy[i]);
            let moved = RowMove::new(rows.r[i] * rows.shape[i], y[i], alpha * dy);
            slope.growth += d * moved.change * dy;
            slope.second += T::select(moved.ends_inside, d, T::ZERO) * dy * dy;
        }
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let mut sum = T::ZERO;
        for i in 0..rows.d.len() {
            let moved = RowMove::new(rows.r[i] * rows.shape[i], y[i], alpha * dy[i]);
            sum += rows.d[i] * moved.change * moved.beyond;
        }
        sum
    }
}

/// The change of one row from y₀ to y₁.
pub(super) struct RowMove<T: Real> {
    /// c₁ − c₀.
    pub change: T,
    /// y₁ − ½ (c₀ + c₁), with the sign of the change.
    pub beyond: T,
    pub ends_inside: T::Mask,
}

impl<T: Real> RowMove<T> {
    #[inline(always)]
    pub(super) fn new(limit: T, y: T, step: T) -> Self {
        let half = T::new(0.5);
        let end = y + step;
        let (c0, c1) = (y.clamp(-limit, limit), end.clamp(-limit, limit));
        let ends_inside = end.abs().lt(limit);
        // Within the quadratic piece both follow from the step, without cancellation.
        let inside = y.abs().lt(limit) & ends_inside;
        RowMove {
            change: T::select(inside, step, c1 - c0),
            beyond: T::select(inside, half * step, end - half * (c0 + c1)),
            ends_inside,
        }
    }
}

/// Returns −1, 0 or 1: the side of the quadratic piece that `y` is on.
#[inline(always)]
fn side<T: Real>(limit: T, y: T) -> T {
    T::select(y.abs().lt(limit), T::ZERO, T::ONE.copysign(y))
}
