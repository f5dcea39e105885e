//! Frictional contact with a linearised cone: a one-sided cost on each edge.
//!
//! The block's rows are the contact frame (normal, then tangents, spin, rolls); the edges are combinations of them:
//!
//! ```text
//! e_j± = y₀ ± μ_j y_j,   j = 1..dim−1,   m = min(e, 0)
//! s = ½ D Σ m²           λ = −D m ≥ 0 along each edge
//! force₀ = Σ λ           force_j = μ_j (λ_j+ − λ_j−)
//! W₀₀ = D Σ active       W₀_j = D μ_j (active_j+ − active_j−)       W_jj = D μ_j² (active_j+ + active_j−)
//! ```
//!
//! The Hessian is therefore an arrow, and friction obeys Σ |force_j| / μ_j ≤ force₀. Pieces: each edge 1 or 0, in the
//! order 1+, 1−, 2+, 2−, ... All rows have the same D.

use super::block_cost::{BlockCost, Form, RankOne, Rows, Slope, Totals, Weight};
use super::one_sided::{active, add_edge_slope, edge_divergence};
use clench_math::{Mask, Real};

pub(crate) struct Pyramid;

impl<T: Real> BlockCost<T> for Pyramid {
    #[inline(always)]
    fn active_len(dim: usize) -> usize {
        2 * dim.saturating_sub(1)
    }

    #[inline(always)]
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    ) {
        let d = rows.d[0];
        let mut normal = T::ZERO;
        let mut squares = T::ZERO;
        for j in 1..rows.d.len() {
            let side = rows.shape[j] * y[j];
            let (plus, minus) = (y[0] + side, y[0] - side);
            let (m, n) = (plus.min(T::ZERO), minus.min(T::ZERO));
            normal += m + n;
            squares += m * m + n * n;
            force[j] = -(d * rows.shape[j] * (m - n));
            totals.mark(&mut active_set[2 * j - 2], active(d, plus));
            totals.mark(&mut active_set[2 * j - 1], active(d, minus));
        }
        force[0] = -(d * normal);
        totals.cost += T::new(0.5) * d * squares;
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, _: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form {
        let d = rows.d[0];
        let mut count = T::ZERO;
        for j in 1..rows.d.len() {
            let (plus, minus) = (active_set[2 * j - 2], active_set[2 * j - 1]);
            let mu = rows.shape[j];
            count += plus + minus;
            weight[0][j] = d * mu * (plus - minus);
            weight[j][j] = d * mu * mu * (plus + minus);
        }
        weight[0][0] = d * count;
        if count.gt(T::ZERO).any() {
            Form::Arrow
        } else {
            Form::Zero
        }
    }

    #[inline(always)]
    fn changes(rows: Rows<T>, old: &[T], new: &[T], mut emit: impl FnMut(RankOne<T>)) {
        for edge in 0..old.len() {
            let j = edge / 2 + 1;
            let mu = if edge % 2 == 0 {
                rows.shape[j]
            } else {
                -rows.shape[j]
            };
            emit(RankOne {
                sigma: rows.d[0] * (new[edge] - old[edge]),
                row: 0,
                side: Some((j, mu)),
            });
        }
    }

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        let d = rows.d[0];
        for j in 1..rows.d.len() {
            let (side, dside) = (rows.shape[j] * y[j], rows.shape[j] * dy[j]);
            add_edge_slope(d, y[0] + side, dy[0] + dside, alpha, slope);
            add_edge_slope(d, y[0] - side, dy[0] - dside, alpha, slope);
        }
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let d = rows.d[0];
        let mut sum = T::ZERO;
        for j in 1..rows.d.len() {
            let (side, dside) = (rows.shape[j] * y[j], rows.shape[j] * dy[j]);
            let (plus, minus) = (y[0] + side, y[0] - side);
            sum += edge_divergence(d, plus, alpha * (dy[0] + dside));
            sum += edge_divergence(d, minus, alpha * (dy[0] - dside));
        }
        sum
    }
}

impl Pyramid {
    /// Writes the force λ along each edge.
    #[inline(always)]
    pub(crate) fn edge_forces<T: Real>(rows: Rows<T>, y: &[T], edges: &mut [T]) {
        for j in 1..rows.d.len() {
            let side = rows.shape[j] * y[j];
            edges[2 * j - 2] = -(rows.d[0] * (y[0] + side).min(T::ZERO));
            edges[2 * j - 1] = -(rows.d[0] * (y[0] - side).min(T::ZERO));
        }
    }
}
