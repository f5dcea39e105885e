//! Equalities.
//!
//! ```text
//! s(y) = ½ Σ D y²      force = −D y      Hessian = diag(D)      one piece
//! s(y + α dy) − s(y) = α Σ D dy (y + ½ α dy)
//! ```

use super::block_cost::{BlockCost, Form, RankOne, Rows, Slope, Totals, Weight};
use clench_math::Real;

pub(crate) struct Quadratic;

impl<T: Real> BlockCost<T> for Quadratic {
    #[inline(always)]
    fn active_len(_: usize) -> usize {
        0
    }

    #[inline(always)]
    fn evaluate(rows: Rows<T>, y: &[T], force: &mut [T], _: &mut [T], totals: &mut Totals<T>) {
        for ((&d, &y), force) in rows.d.iter().zip(y).zip(force) {
            *force = -(d * y);
            totals.cost += T::new(0.5) * d * y * y;
        }
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, _: &[T], _: &[T], weight: &mut Weight<T>) -> Form {
        for (i, &d) in rows.d.iter().enumerate() {
            weight[i][i] = d;
        }
        Form::Diagonal
    }

    #[inline(always)]
    fn changes(_: Rows<T>, _: &[T], _: &[T], _: impl FnMut(RankOne<T>)) {}

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        for ((&d, &y), &dy) in rows.d.iter().zip(y).zip(dy) {
            slope.first += d * (y + alpha * dy) * dy;
            slope.second += d * dy * dy;
        }
    }

    #[inline(always)]
    fn change(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let mut sum = T::ZERO;
        for ((&d, &y), &dy) in rows.d.iter().zip(y).zip(dy) {
            sum += d * dy * (y + T::new(0.5) * alpha * dy);
        }
        alpha * sum
    }
}
