//! Equalities.
//!
//! ```text
//! s(y) = ½ Σ D y²      force = −D y      Hessian = diag(D)      one piece
//! divergence along a ray: ½ α² Σ D dy²
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
    fn slope(rows: Rows<T>, _: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        for (&d, &dy) in rows.d.iter().zip(dy) {
            let second = d * dy * dy;
            slope.growth += alpha * second;
            slope.second += second;
        }
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, _: &[T], dy: &[T], alpha: T) -> T {
        let mut sum = T::ZERO;
        for (&d, &dy) in rows.d.iter().zip(dy) {
            sum += d * dy * dy;
        }
        T::new(0.5) * alpha * alpha * sum
    }
}
