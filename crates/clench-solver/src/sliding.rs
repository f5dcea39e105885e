//! The linear system of a prediction, solved by elimination.
//!
//! [`prediction`](crate::prediction) seeks δ with (I − D J_n H⁻¹ B) δ = f − λ + D J_n H⁻¹ g, one unknown a sliding
//! contact. With the factor H = LᵀEL, its matrix needs solves only along the paths of the contacts' dofs:
//!
//! ```text
//! J_n H⁻¹ B = (E⁻¹ L⁻ᵀ J_nᵀ)ᵀ (L⁻ᵀ B)
//! ```

use crate::hessian::{Hessian, PathPairs};
use clench_math::{Mask, Real, Scalar, kernel};

/// The system, and its memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlidingSystem<T> {
    /// E⁻¹ L⁻ᵀ times the row of J_n, and L⁻ᵀ times the column of B, of each contact.
    pairs: PathPairs<T>,
    /// The entries of both at the dofs of the contact.
    entries: Vec<[T; 2]>,
    /// The matrix of the system, row-major; elimination overwrites it.
    matrix: Vec<T>,
    /// 1 where a contact jams, else 0.
    jams: Vec<T>,
}

impl<T: Real> SlidingSystem<T> {
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Appends a contact on `dofs`, with its rows of J, the normal first, and the directions of sliding friction.
    #[kernel]
    pub fn push(&mut self, hessian: &mut Hessian<T>, dofs: &[u32], rows: &[T], friction: &[T]) {
        self.entries.clear();
        for k in 0..dofs.len() {
            let mut column = T::ZERO;
            for (row, &friction) in rows.chunks_exact(dofs.len().max(1)).zip(friction) {
                column += friction * row[k];
            }
            self.entries.push([rows[k], column]);
        }
        hessian.push_pair(dofs, &self.entries, &mut self.pairs);
    }

    /// Replaces `right`, f − λ of each contact, by δ, and `step`, g, by H⁻¹ (g + B δ). `weights` are D; they and
    /// `right` are zero in lanes in which a contact does not slide. δ is zero where a contact jams.
    #[kernel]
    pub fn solve(
        &mut self,
        hessian: &mut Hessian<T>,
        weights: &[T],
        right: &mut [T],
        step: &mut [T],
    ) {
        let count = right.len();
        hessian.solve_transposed(step);
        self.matrix.clear();
        for i in 0..count {
            right[i] += weights[i] * self.pairs.product_with(i, step);
            for j in 0..count {
                self.matrix.push(-(weights[i] * self.pairs.product(i, j)));
            }
            self.matrix[i * count + i] += T::ONE;
        }
        self.jams.clear();
        eliminate(&mut self.matrix, right, &mut self.jams);
        for (i, &delta) in right.iter().enumerate() {
            self.pairs.add_second(i, delta, step);
        }
        hessian.complete_solve(step);
    }

    /// Returns the lanes in which a contact jams.
    #[inline(always)]
    pub(crate) fn jams(&self, contact: usize) -> T::Mask {
        self.jams[contact].gt(T::ZERO)
    }
}

/// Replaces `x` by the solution of A y = x, without pivoting. Where a pivot is not positive the unknown becomes zero,
/// and `jams` gets a 1, else a 0.
#[inline(always)]
fn eliminate<T: Real>(a: &mut [T], x: &mut [T], jams: &mut Vec<T>) {
    let n = x.len();
    let smallest = T::splat(T::Scalar::EPSILON).sqrt();
    for k in 0..n {
        let (above, below) = a.split_at_mut((k + 1) * n);
        let pivots = &mut above[k * n..];
        let regular = pivots[k].gt(smallest);
        jams.push(T::select(regular, T::ZERO, T::ONE));
        if !regular.all() {
            x[k] = T::select(regular, x[k], T::ZERO);
            pivots[k] = T::select(regular, pivots[k], T::ONE);
            for entry in &mut pivots[k + 1..] {
                *entry = T::select(regular, *entry, T::ZERO);
            }
        }
        let inverse = T::ONE / pivots[k];
        for (row, i) in below.chunks_exact_mut(n).zip(k + 1..) {
            let multiplier = row[k] * inverse;
            for (entry, &above) in row[k + 1..].iter_mut().zip(&pivots[k + 1..]) {
                *entry -= multiplier * above;
            }
            let above = x[k];
            x[i] -= multiplier * above;
        }
    }
    for k in (0..n).rev() {
        let row = &a[k * n..(k + 1) * n];
        let mut rest = x[k];
        for (&entry, &x) in row[k + 1..].iter().zip(&x[k + 1..]) {
            rest -= entry * x;
        }
        x[k] = rest / row[k];
    }
}
