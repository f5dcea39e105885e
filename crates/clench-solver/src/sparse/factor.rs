//! The factorization H = LᵀDL of what a [`SparsePattern`] stores.
//!
//! A supernode's rows are done when their turn comes; what they take off the rows above, `A_ij −= L_ki U_kj` with U = D L, is subtracted at once,
//! in tiles that stay in registers. Every entry is changed by the rows below in the same order as over a [`Tree`](crate::Tree), from the last
//! to the first, and by each alone, **so that both give the same bits**.

use super::pattern::{MAX_DOFS, SparsePattern, Supernode};
use super::tiles::{NARROW, Rows, Tiles};
use crate::jacobian::Pattern;
use crate::{Tree, TreeMatrix};
use clench_math::{Mask, Real, Scalar, array, kernel};

/// The matrix, and in its place the factor.
#[derive(Clone, Debug, Default)]
pub(crate) struct SparseFactor<T> {
    /// The blocks of the supernodes, row by row: of the matrix, then of L.
    pub(super) values: Vec<T>,
    /// The diagonal of the matrix, then D; 1 / D.
    diagonal: Vec<T>,
    pub(super) inverse: Vec<T>,
    /// U of the supernode at hand; of a solve, the numbers in its columns.
    upper: Vec<T>,
    pub(super) gathered: Vec<T>,
}

impl<T: Real> SparseFactor<T> {
    /// Becomes the zero matrix over `pattern`.
    pub(crate) fn clear(&mut self, pattern: &SparsePattern) {
        self.values.clear();
        self.values.resize(pattern.nnz(), T::ZERO);
        for v in [&mut self.diagonal, &mut self.inverse] {
            v.resize(pattern.nv(), T::ZERO);
        }
    }

    /// The matrix, to be written before it is factored.
    pub(crate) fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Adds a matrix over `tree`, whose entries `pattern` holds.
    #[kernel]
    pub fn add_matrix(&mut self, pattern: &SparsePattern, tree: &Tree, matrix: &TreeMatrix<T>) {
        for dof in 0..tree.nv() {
            let row = matrix.row(tree, dof);
            pattern.add_to_row(
                tree.row(dof),
                &mut self.values,
                #[inline(always)]
                |c| row[c],
            );
        }
    }

    /// Factors the matrix; a pivot that rounding has consumed is replaced by the diagonal it came from.
    pub(crate) fn factor_safely(&mut self, pattern: &SparsePattern) {
        // Its tiles have columns enough to fill registers with, even of a single environment.
        T::vectorize_rows(
            #[inline(always)]
            || self.factor_rows(pattern),
        );
    }

    #[inline(always)]
    fn factor_rows(&mut self, pattern: &SparsePattern) {
        for s in pattern.supernodes() {
            for m in 0..s.len {
                self.diagonal[s.first + m] = self.values[s.start + m * s.width() + s.shared() + m];
            }
        }
        for s in pattern.supernodes() {
            self.factor_block(s);
            self.update_ancestors(pattern, s);
        }
    }

    /// Turns the rows of a supernode, from which all rows below are taken off, into those of L, and leaves those of U in `upper`.
    #[inline(always)]
    fn factor_block(&mut self, s: &Supernode) {
        let (width, shared) = (s.width(), s.shared());
        let floor = T::splat(T::Scalar::EPSILON);
        let block = &mut self.values[s.block()];
        // What row k takes off row m is this times row k. First in the columns of the supernode itself, which give the pivots.
        let mut multipliers = [[T::ZERO; MAX_DOFS]; MAX_DOFS];
        for m in (0..s.len).rev() {
            let (above, below) = block.split_at_mut((m + 1) * width);
            let row = &mut above[m * width + shared..][..=m];
            for k in (m + 1..s.len).rev() {
                let other = &below[(k - m - 1) * width + shared..][..=m];
                let multiplier = other[m] * self.inverse[s.first + k];
                multipliers[m][k] = multiplier;
                for (x, &u) in row.iter_mut().zip(other) {
                    *x -= multiplier * u;
                }
            }
            let dof = s.first + m;
            let (pivot, diagonal) = (row[m], self.diagonal[dof]);
            let pivot = T::select(pivot.gt(floor * diagonal), pivot, diagonal);
            self.diagonal[dof] = pivot;
            self.inverse[dof] = T::ONE / pivot;
        }
        // Then in the columns left of them.
        let mut column = 0;
        while column < shared {
            column += match shared - column {
                NARROW.. => subtract_multiples::<T, NARROW>(block, width, column, &multipliers),
                2.. => subtract_multiples::<T, 2>(block, width, column, &multipliers),
                _ => subtract_multiples::<T, 1>(block, width, column, &multipliers),
            };
        }
        self.upper.clear();
        self.upper.extend_from_slice(block);
        for (m, row) in block.chunks_exact_mut(width).enumerate() {
            for x in row {
                *x *= self.inverse[s.first + m];
            }
        }
    }

    /// Takes what the rows of a supernode take off the rows above.
    #[inline(always)]
    fn update_ancestors(&mut self, pattern: &SparsePattern, s: &Supernode) {
        let (done, above) = self.values.split_at_mut(s.block().end);
        let mut tiles = Tiles {
            lower: &done[s.start..],
            upper: &self.upper,
            len: s.len,
            width: s.width(),
            above,
            offset: s.block().end,
        };
        let runs = pattern.runs(s);
        let columns = pattern.columns(s);
        let mut first = 0;
        while first < columns.len() {
            let target = pattern.supernode_of(columns[first] as usize);
            let end = target.first + target.len;
            let count = columns[first..]
                .iter()
                .take_while(|&&dof| (dof as usize) < end)
                .count();
            let rows = Rows {
                dofs: &columns[first..first + count],
                place: first,
                target,
            };
            tiles.subtract(&rows, runs, pattern.runs(target));
            first += count;
        }
    }

    /// Turns the factor of A into that of A + σ x xᵀ, where the last dof with a number in x (by dof) is `last`; x is zero afterwards. False in lanes
    /// where the change consumes a pivot. See [`TreeFactor::update`](crate::TreeFactor).
    #[kernel]
    pub fn update(
        &mut self,
        pattern: &SparsePattern,
        last: usize,
        x: &mut [T],
        mut sigma: T,
    ) -> T::Mask {
        let consumed = T::splat(T::Scalar::EPSILON).sqrt();
        let mut good = T::Mask::splat(true);
        let mut next = Some(last);
        while let Some(dof) = next {
            let s = pattern.supernode_of(dof);
            let (m, columns) = (dof - s.first, pattern.columns(s));
            next = if m > 0 {
                Some(dof - 1)
            } else {
                columns.last().map(|&c| c as usize)
            };
            let p = std::mem::replace(&mut x[dof], T::ZERO);
            if p.eq(T::ZERO).all() {
                continue;
            }
            let old = self.diagonal[dof];
            let new = old + sigma * p * p;
            good &= new.gt(consumed * old);
            let inverse = T::ONE / new;
            let beta = sigma * p * inverse;
            sigma *= old / new;
            self.diagonal[dof] = new;
            self.inverse[dof] = inverse;
            let row = &mut self.values[s.start + m * s.width()..][..s.shared() + m];
            let own = s.first as u32..dof as u32;
            for (l, column) in row.iter_mut().zip(columns.iter().copied().chain(own)) {
                let x = &mut x[column as usize];
                *x -= p * *l;
                *l += beta * *x;
            }
        }
        good
    }

    /// Takes the lanes of `mask` from `other`, a factor over the same pattern.
    #[kernel]
    pub fn take(&mut self, mask: T::Mask, other: &SparseFactor<T>) {
        for (to, from) in [
            (&mut self.values, &other.values),
            (&mut self.diagonal, &other.diagonal),
            (&mut self.inverse, &other.inverse),
        ] {
            for (to, &from) in to.iter_mut().zip(from) {
                *to = T::select(mask, from, *to);
            }
        }
    }
}

/// Subtracts from each row of a block, the last first, multiples of the rows after it, in N columns; returns their number.
#[inline(always)]
fn subtract_multiples<T: Real, const N: usize>(
    block: &mut [T],
    width: usize,
    column: usize,
    multipliers: &[[T; MAX_DOFS]; MAX_DOFS],
) -> usize {
    let len = block.len() / width;
    for m in (0..len).rev() {
        let start = m * width + column;
        let mut left: [T; N] = array(|c| block[start + c]);
        for k in (m + 1..len).rev() {
            let other = &block[k * width + column..][..N];
            for c in 0..N {
                left[c] -= multipliers[m][k] * other[c];
            }
        }
        block[start..start + N].copy_from_slice(&left);
    }
    N
}
