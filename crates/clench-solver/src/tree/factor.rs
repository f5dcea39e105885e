//! The factorization LᵀDL in the pattern of a tree.
//!
//! With U = D L, row i is `U_i = A_i − Σ_k L_ki U_k` over the descendants k of i, of whose rows it takes the beginning. A few
//! columns at a time stay in registers while the sum runs. Every entry sums in the same order, and an entry that is zero
//! contributes an exact zero, **so that a larger pattern gives the same bits**.

use super::{Tree, TreeMatrix};
use clench_math::{Mask, Real, Scalar, kernel};

/// Columns summed at a time: one or a few registers.
const WIDTH: usize = 4;

/// The factorization A = LᵀDL of a [`TreeMatrix`], L unit lower triangular in the same pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeFactor<T> {
    /// L, row by row; its diagonal of ones is not stored but left as it comes.
    lower: Vec<T>,
    /// U = D L, needed only while factoring.
    scaled: Vec<T>,
    /// D and 1 / D.
    diagonal: Vec<T>,
    inverse: Vec<T>,
}

impl<T: Real> TreeFactor<T> {
    /// An empty factor, to be filled by [`factor`](Self::factor).
    pub fn zeros(tree: &Tree) -> Self {
        let mut factor = TreeFactor::default();
        factor.resize(tree);
        factor
    }

    #[inline(always)]
    pub(crate) fn resize(&mut self, tree: &Tree) {
        self.lower.resize(tree.nnz(), T::ZERO);
        self.scaled.resize(tree.nnz(), T::ZERO);
        self.diagonal.resize(tree.nv(), T::ZERO);
        self.inverse.resize(tree.nv(), T::ZERO);
    }

    /// Factors `matrix`. False in lanes that met a pivot that is not positive: their factor is not usable.
    pub fn factor(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) -> T::Mask {
        self.factor_above(tree, matrix, T::ZERO)
    }

    /// Factors `matrix`; a pivot that rounding has consumed is replaced by the diagonal it came
    /// from, so that what is solved with it stays finite and a direction of descent.
    pub(crate) fn factor_safely(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) {
        self.factor_above(tree, matrix, T::splat(T::Scalar::EPSILON));
    }

    /// Factors; pivots below `floor` times the diagonal are replaced by the diagonal.
    #[kernel]
    fn factor_above(&mut self, tree: &Tree, matrix: &TreeMatrix<T>, floor: T) -> T::Mask {
        self.resize(tree);
        let mut positive = T::Mask::splat(true);
        for i in (0..tree.nv()).rev() {
            self.sum_row(tree, i, &matrix.values);
            let row = tree.starts[i]..tree.starts[i + 1];
            let pivot = self.scaled[row.end - 1];
            positive &= pivot.gt(T::ZERO) & pivot.is_finite();
            let diagonal = matrix.values[row.end - 1];
            let pivot = T::select(pivot.gt(floor * diagonal), pivot, diagonal);
            let inverse = T::ONE / pivot;
            self.diagonal[i] = pivot;
            self.inverse[i] = inverse;
            for (l, &u) in self.lower[row.clone()].iter_mut().zip(&self.scaled[row]) {
                *l = u * inverse;
            }
        }
        positive
    }

    /// Computes row `i` of U. Windows of columns may overlap: each starts from `values`, which
    /// stay as they are.
    #[inline(always)]
    fn sum_row(&mut self, tree: &Tree, i: usize, values: &[T]) {
        let (start, end) = (tree.starts[i], tree.starts[i + 1]);
        let (done, below) = self.scaled.split_at_mut(end);
        let sum = RowSum {
            values: &values[start..end],
            lower: &self.lower[end..tree.nnz()],
            scaled: &below[..tree.nnz() - end],
            descendants: tree.descendants(i),
            offset: end,
        };
        let row = &mut done[start..];
        match row.len() {
            1 => sum.window::<1>(row, 0),
            2 => sum.window::<2>(row, 0),
            3 => sum.window::<3>(row, 0),
            len => {
                for column in (0..=len - WIDTH).step_by(WIDTH) {
                    sum.window::<WIDTH>(row, column);
                }
                if !len.is_multiple_of(WIDTH) {
                    sum.window::<WIDTH>(row, len - WIDTH);
                }
            }
        }
    }

    /// Turns the factor of A into that of A + σ x xᵀ, x given along the path to dof `last` and
    /// overwritten. Where σ is zero nothing changes, to the bit. False in lanes where the change
    /// consumes a pivot: their factor is not usable any more.
    ///
    /// Method C1 of Gill, Golub, Murray and Saunders (*Methods for modifying matrix
    /// factorizations*, 1974), from the last row to the first.
    #[kernel]
    pub(crate) fn update(
        &mut self,
        tree: &Tree,
        last: usize,
        x: &mut [T],
        mut sigma: T,
    ) -> T::Mask {
        let consumed = T::splat(T::Scalar::EPSILON).sqrt();
        let mut good = T::Mask::splat(true);
        for (depth, &k) in tree.row(last).iter().enumerate().rev() {
            let k = k as usize;
            let (p, old) = (x[depth], self.diagonal[k]);
            let new = old + sigma * p * p;
            good &= new.gt(consumed * old);
            let inverse = T::ONE / new;
            let beta = sigma * p * inverse;
            sigma *= old / new;
            self.diagonal[k] = new;
            self.inverse[k] = inverse;
            let row = &mut self.lower[tree.starts[k]..tree.starts[k] + depth];
            for (l, x) in row.iter_mut().zip(&mut *x) {
                *x -= p * *l;
                *l += beta * *x;
            }
        }
        good
    }

    /// Takes the lanes of `mask` from `other`, a factor over the same tree.
    #[kernel]
    pub(crate) fn take(&mut self, mask: T::Mask, other: &TreeFactor<T>) {
        for (to, from) in [
            (&mut self.lower, &other.lower),
            (&mut self.diagonal, &other.diagonal),
            (&mut self.inverse, &other.inverse),
        ] {
            for (to, &from) in to.iter_mut().zip(from) {
                *to = T::select(mask, from, *to);
            }
        }
    }

    /// Becomes the part of `whole`, the factor over `tree`, that belongs to the complete trees of `dofs`.
    pub(crate) fn gather(&mut self, tree: &Tree, whole: &TreeFactor<T>, dofs: &[u32]) {
        self.lower.clear();
        self.diagonal.clear();
        self.inverse.clear();
        for &dof in dofs {
            let dof = dof as usize;
            self.lower
                .extend_from_slice(&whole.lower[tree.starts[dof]..tree.starts[dof + 1]]);
            self.diagonal.push(whole.diagonal[dof]);
            self.inverse.push(whole.inverse[dof]);
        }
    }

    /// Becomes lane `lane` of `whole`.
    pub(crate) fn gather_lane<L: Real<Scalar = T>>(&mut self, whole: &TreeFactor<L>, lane: usize) {
        for (to, from) in [
            (&mut self.lower, &whole.lower),
            (&mut self.diagonal, &whole.diagonal),
            (&mut self.inverse, &whole.inverse),
        ] {
            to.clear();
            to.extend(from.iter().map(|x| x.lane(lane)));
        }
    }

    /// `x ← A⁻¹ x`.
    #[kernel]
    pub fn solve(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        for (x, &inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= inverse;
        }
        for k in 0..tree.nv() {
            let (first, lead, others) = tree.split_row(k);
            let row = &self.lower[tree.starts[k]..];
            let mut sum = x[k];
            for (&l, &x) in row.iter().zip(&x[first..first + lead]) {
                sum -= l * x;
            }
            for (&l, &c) in row[lead..].iter().zip(others) {
                sum -= l * x[c as usize];
            }
            x[k] = sum;
        }
    }

    /// `x ← D^(-1/2) L^(-T) x`: afterwards `x·y` is the product `xᵀA⁻¹y` of what was given.
    #[kernel]
    pub fn solve_half(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        for (x, &inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= inverse.sqrt();
        }
    }

    #[inline(always)]
    fn solve_transposed(&self, tree: &Tree, x: &mut [T]) {
        for k in (0..tree.nv()).rev() {
            let (first, lead, others) = tree.split_row(k);
            let row = &self.lower[tree.starts[k]..];
            let xk = x[k];
            for (&l, x) in row.iter().zip(&mut x[first..first + lead]) {
                *x -= l * xk;
            }
            for (&l, &c) in row[lead..].iter().zip(others) {
                x[c as usize] -= l * xk;
            }
        }
    }
}

/// The sum that makes a row of U.
struct RowSum<'a, T> {
    /// The row of A.
    values: &'a [T],
    /// L and U from the row's end on.
    lower: &'a [T],
    scaled: &'a [T],
    /// Where the rows of the descendants start, from `offset` on.
    descendants: &'a [u32],
    offset: usize,
}

impl<T: Real> RowSum<'_, T> {
    /// Computes `N` columns.
    #[inline(always)]
    fn window<const N: usize>(&self, row: &mut [T], column: usize) {
        let depth = row.len() - 1;
        let mut sum: [T; N] = std::array::from_fn(|c| self.values[column + c]);
        for &start in self.descendants {
            let start = start as usize - self.offset;
            debug_assert!(start + depth < self.lower.len() && column + N <= depth + 1);
            // SAFETY: `start` is where the row of a descendant starts, which holds more than
            // `depth` entries: a tree is built so, and `lower` and `scaled` reach to its end.
            // The checks were half of the instructions of this loop, the hottest of all.
            unsafe {
                let multiplier = *self.lower.get_unchecked(start + depth);
                for c in 0..N {
                    sum[c] -= multiplier * *self.scaled.get_unchecked(start + column + c);
                }
            }
        }
        row[column..column + N].copy_from_slice(&sum);
    }
}
