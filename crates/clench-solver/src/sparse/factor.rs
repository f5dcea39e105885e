//! The factorization H = LᵀDL over a [`SparsePattern`].
//!
//! To factor a supernode, the contributions of the rows below, `A_ij −= L_ki U_kj` with U = D L, are subtracted in
//! tiles that stay in registers; then its own block is factored. (This is the left-looking form: Davis, *Direct Methods
//! for Sparse Linear Systems*, 2006, §4.8.) Every entry is changed by one row below at a time, in the same order as
//! over a [`Tree`](crate::Tree), from the last to the first. **So both give the same bits**, with any number of
//! threads, which share the supernodes ([`Elimination`]).

use super::elimination::{Elimination, Open, Spare};
use super::pattern::{MAX_DOFS, SparsePattern, Supernode};
use super::tiles::{NARROW, Rows, Tiles};
use crate::threads::Threads;
use clench_math::{Mask, Real, Scalar, array, kernel};

/// The matrix, replaced by its factor.
#[derive(Clone, Debug, Default)]
pub(crate) struct SparseFactor<T: 'static> {
    /// The blocks of the supernodes, row by row: of the matrix, then of L.
    pub(super) values: Vec<T>,
    /// The blocks of U as of the factorization; updates do not change them.
    upper: Vec<T>,
    /// The diagonal of the matrix, then D; 1 / D.
    diagonal: Vec<T>,
    pub(super) inverse: Vec<T>,
    /// The entries of x in a supernode's columns, during a solve.
    pub(super) gathered: Vec<T>,
    spare: Spare<T>,
}

impl<T: Real> SparseFactor<T> {
    /// Resizes the memory for a matrix over `pattern`.
    pub(crate) fn resize(&mut self, pattern: &SparsePattern) {
        for v in [&mut self.values, &mut self.upper] {
            v.resize(pattern.nnz(), T::ZERO);
        }
        for v in [&mut self.diagonal, &mut self.inverse] {
            v.resize(pattern.nv(), T::ZERO);
        }
    }

    /// Returns the values of the matrix, to be written before factoring.
    pub(crate) fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Factors the matrix. A pivot lost to rounding is replaced by the original diagonal entry.
    pub(crate) fn factor_safely(&mut self, pattern: &SparsePattern, threads: &Threads) {
        let (memory, spare) = (
            [
                &mut self.values[..],
                &mut self.upper,
                &mut self.diagonal,
                &mut self.inverse,
            ],
            &mut self.spare,
        );
        Elimination::run(pattern, memory, spare, |elimination| {
            // Tiles have enough columns to fill registers, even in a single environment.
            threads.on_each(|| {
                T::vectorize_rows(
                    #[inline(always)]
                    || eliminate(pattern, elimination),
                )
            });
        });
    }

    /// Updates the factor of A to that of A + σ x xᵀ. `last` is the last dof with a nonzero entry in x, which is
    /// indexed by dof and zero afterwards. Returns false in lanes in which the change consumes a pivot. See
    /// [`TreeFactor::update`](crate::TreeFactor).
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
            let columns = pattern.columns_of_row(s, dof);
            next = columns.clone().next_back().map(|c| c as usize);
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
            let row = &mut self.values[s.row(dof)];
            for (l, column) in row.iter_mut().zip(columns) {
                let x = &mut x[column as usize];
                *x -= p * *l;
                *l += beta * *x;
            }
        }
        good
    }

    /// Copies the lanes of `mask` from `other`, a factor over the same pattern.
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

/// Factors supernodes until all are claimed.
#[inline(always)]
fn eliminate<T: Real>(pattern: &SparsePattern, elimination: &Elimination<T>) {
    let _watch = elimination.watch();
    while let Some((s, mut open)) = elimination.claim(pattern) {
        for m in 0..s.len {
            open.diagonal[m] = open.values[m * s.width() + s.shared() + m];
        }
        for update in pattern.updates(s) {
            let source = &pattern.supernodes()[update.source as usize];
            let Some(done) = elimination.wait(update.source as usize) else {
                return;
            };
            let mut tiles = Tiles {
                lower: done.lower,
                upper: done.upper,
                len: source.len,
                width: source.width(),
                above: &mut *open.values,
                target: s,
            };
            let offset = update.offset as usize;
            let rows = Rows {
                dofs: &pattern.columns(source)[offset..offset + update.count as usize],
                offset,
            };
            tiles.subtract(&rows, pattern.runs(source), pattern.runs(s));
        }
        factor_block(s, &mut open);
        elimination.close(open);
    }
}

/// Replaces the rows of a supernode, from which all rows below are subtracted, by those of L, and copies those of U to
/// `open.upper`.
#[inline(always)]
fn factor_block<T: Real>(s: &Supernode, open: &mut Open<T>) {
    let (width, shared) = (s.width(), s.shared());
    let floor = T::splat(T::Scalar::EPSILON);
    let block = &mut *open.values;
    // Row k times this is subtracted from row m. First in the supernode's own columns, which give the pivots.
    let mut multipliers = [[T::ZERO; MAX_DOFS]; MAX_DOFS];
    for m in (0..s.len).rev() {
        let (above, below) = block.split_at_mut((m + 1) * width);
        let row = &mut above[m * width + shared..][..=m];
        for k in (m + 1..s.len).rev() {
            let other = &below[(k - m - 1) * width + shared..][..=m];
            let multiplier = other[m] * open.inverse[k];
            multipliers[m][k] = multiplier;
            for (x, &u) in row.iter_mut().zip(other) {
                *x -= multiplier * u;
            }
        }
        let (pivot, diagonal) = (row[m], open.diagonal[m]);
        let pivot = T::select(pivot.gt(floor * diagonal), pivot, diagonal);
        open.diagonal[m] = pivot;
        open.inverse[m] = T::ONE / pivot;
    }
    // Then in the columns to the left.
    let mut column = 0;
    while column < shared {
        column += match shared - column {
            NARROW.. => subtract_multiples::<T, NARROW>(block, width, column, &multipliers),
            2.. => subtract_multiples::<T, 2>(block, width, column, &multipliers),
            _ => subtract_multiples::<T, 1>(block, width, column, &multipliers),
        };
    }
    open.upper.copy_from_slice(block);
    for (m, row) in block.chunks_exact_mut(width).enumerate() {
        for x in row {
            *x *= open.inverse[m];
        }
    }
}

/// Subtracts from each row of a block, last to first, multiples of the rows after it, in N columns. Returns N.
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
