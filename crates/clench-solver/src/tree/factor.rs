//! The factorization LᵀDL in the pattern of a tree.
//!
//! With U = D L, row i is `U_i = A_i − Σ_k L_ki U_k` over the descendants k of i, of whose rows it uses the prefix. A
//! few rows and columns at a time stay in registers while the sum runs. Every entry sums in the same order, from the
//! last descendant to the first, and a zero entry contributes an exact zero, **so a larger pattern gives the same
//! bits**.

use super::{Tree, TreeMatrix, TreeSupernode, with_len};
use crate::runs::runs;
use crate::transfer::Transfer;
use clench_math::{Mask, Real, Scalar, array, kernel};

/// The number of columns summed at a time.
const WIDTH: usize = 4;

/// The factorization A = LᵀDL of a [`TreeMatrix`], L unit lower triangular in the same pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeFactor<T> {
    /// L, row by row; its unit diagonal is not stored, and those entries are undefined.
    pub(super) lower: Vec<T>,
    /// U = D L, needed only while factoring.
    scaled: Vec<T>,
    /// D and 1 / D.
    pub(super) diagonal: Vec<T>,
    pub(super) inverse: Vec<T>,
}

impl<T: Real> TreeFactor<T> {
    /// Creates an empty factor, to be filled by [`factor`](Self::factor).
    pub fn zeros(tree: &Tree) -> Self {
        let mut factor = TreeFactor::default();
        factor.resize(tree);
        factor
    }

    /// Returns true if the factor has no dofs.
    pub fn is_empty(&self) -> bool {
        self.diagonal.is_empty()
    }

    /// Empties the factor but keeps its memory.
    pub fn clear(&mut self) {
        self.lower.clear();
        self.scaled.clear();
        self.diagonal.clear();
        self.inverse.clear();
    }

    /// Copies another factor into the existing memory.
    pub fn copy_from(&mut self, other: &TreeFactor<T>) {
        self.lower.clone_from(&other.lower);
        self.diagonal.clone_from(&other.diagonal);
        self.inverse.clone_from(&other.inverse);
    }

    #[inline(always)]
    pub(crate) fn resize(&mut self, tree: &Tree) {
        self.lower.resize(tree.nnz(), T::ZERO);
        self.scaled.resize(tree.nnz(), T::ZERO);
        self.diagonal.resize(tree.nv(), T::ZERO);
        self.inverse.resize(tree.nv(), T::ZERO);
    }

    /// Factors `matrix`. Returns false in lanes with a pivot that is not positive: their factor is not usable.
    pub fn factor(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) -> T::Mask {
        self.factor_above(tree, matrix, T::ZERO)
    }

    /// Factors `matrix`. A pivot lost to rounding is replaced by the original diagonal entry, so that solutions stay
    /// finite and directions of descent.
    pub(crate) fn factor_safely(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) {
        self.factor_above(tree, matrix, T::splat(T::Scalar::EPSILON));
    }

    /// Factors `matrix`; pivots below `floor` times the diagonal are replaced by the diagonal.
    #[kernel]
    fn factor_above(&mut self, tree: &Tree, matrix: &TreeMatrix<T>, floor: T) -> T::Mask {
        self.resize(tree);
        let mut positive = T::Mask::splat(true);
        for &TreeSupernode { first, len } in tree.supernodes.iter().rev() {
            positive &=
                with_len!(len, LEN => self.factor_supernode::<LEN>(tree, first, matrix, floor));
        }
        positive
    }

    /// Computes the rows of a supernode whose descendants are done.
    #[inline(always)]
    fn factor_supernode<const LEN: usize>(
        &mut self,
        tree: &Tree,
        first: usize,
        matrix: &TreeMatrix<T>,
        floor: T,
    ) -> T::Mask {
        let depth = tree.depth(first);
        let starts: [usize; LEN] = array(|m| tree.starts[first + m]);
        let end = tree.starts[first + LEN];
        let (lower, lower_below) = self.lower.split_at_mut(end);
        let (scaled, scaled_below) = self.scaled.split_at_mut(end);
        let below = Below {
            lower: &lower_below[..tree.nnz() - end],
            scaled: &scaled_below[..tree.nnz() - end],
            rows: tree.descendants(first + LEN - 1),
            offset: end,
        };
        let rows: [&[T]; LEN] = tree.supernode_rows(&matrix.values, first);

        // The rows of the supernode in its own columns: pivots, and multipliers between its rows.
        let mut block = below.block(depth, &rows);
        let mut inverse = [T::ZERO; LEN];
        let mut positive = T::Mask::splat(true);
        for m in (0..LEN).rev() {
            for k in (m + 1..LEN).rev() {
                let multiplier = block[k][m] * inverse[k];
                for j in 0..=m {
                    block[m][j] -= multiplier * block[k][j];
                }
            }
            let (pivot, diagonal) = (block[m][m], rows[m][depth + m]);
            positive &= pivot.gt(T::ZERO) & pivot.is_finite();
            let pivot = T::select(pivot.gt(floor * diagonal), pivot, diagonal);
            inverse[m] = T::ONE / pivot;
            self.diagonal[first + m] = pivot;
            self.inverse[first + m] = inverse[m];
            for j in 0..=m {
                scaled[starts[m] + depth + j] = block[m][j];
                lower[starts[m] + depth + j] = block[m][j] * inverse[m];
            }
        }

        let mut columns = Columns {
            depth,
            starts,
            block: &block,
            inverse: &inverse,
            lower,
            scaled,
        };
        columns.fill(&below, &rows);
        positive
    }

    /// Writes row `i` of a factor from its pivot D_i, and D_i L_ij as a function of the ancestor j. Returns false in
    /// lanes whose pivot is not positive: their factor is not usable.
    #[inline(always)]
    pub fn set_row(
        &mut self,
        tree: &Tree,
        i: usize,
        pivot: T,
        scaled: impl Fn(usize) -> T,
    ) -> T::Mask {
        let inverse = T::ONE / pivot;
        self.diagonal[i] = pivot;
        self.inverse[i] = inverse;
        let (start, depth) = (tree.row_start(i), tree.depth(i));
        for (l, &j) in self.lower[start..start + depth].iter_mut().zip(tree.row(i)) {
            *l = scaled(j as usize) * inverse;
        }
        pivot.gt(T::ZERO) & pivot.is_finite()
    }

    /// Updates the factor of A to that of A + σ x xᵀ, with x stored along the path to dof `last` and overwritten. If σ
    /// is zero the factor stays the same to the bit. Returns false in lanes in which the change consumes a pivot: their
    /// factor is no longer usable.
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

    /// Copies the lanes of `mask` from `other`, a factor over the same tree.
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

    /// Copies the part of `whole`, the factor over `tree`, that belongs to the complete trees of `dofs`.
    pub(crate) fn gather<L: Real>(
        &mut self,
        tree: &Tree,
        whole: &TreeFactor<L>,
        dofs: &[u32],
        transfer: impl Transfer<L, T>,
    ) {
        self.lower.clear();
        self.diagonal.clear();
        self.inverse.clear();
        for run in runs(dofs) {
            let rows = tree.starts[run.start]..tree.starts[run.end];
            for (to, from) in [
                (&mut self.lower, &whole.lower[rows]),
                (&mut self.diagonal, &whole.diagonal[run.clone()]),
                (&mut self.inverse, &whole.inverse[run]),
            ] {
                to.extend(from.iter().map(|&x| transfer.convert(x)));
            }
        }
    }
}

/// The finished descendants of a supernode.
struct Below<'a, T> {
    /// L and U from the supernode's end on.
    lower: &'a [T],
    scaled: &'a [T],
    /// The starts of the rows of the descendants, all from `offset` on.
    rows: &'a [u32],
    offset: usize,
}

impl<T: Real> Below<'_, T> {
    /// Returns `N` columns of the supernode's rows of A, from `column` on, minus the contributions of the descendants.
    #[inline(always)]
    fn window<const LEN: usize, const N: usize>(
        &self,
        depth: usize,
        column: usize,
        rows: &[&[T]; LEN],
    ) -> [[T; N]; LEN] {
        let mut sums = [[T::ZERO; N]; LEN];
        for m in 0..LEN {
            sums[m].copy_from_slice(&rows[m][column..column + N]);
        }
        for &start in self.rows.iter().rev() {
            let start = start as usize - self.offset;
            debug_assert!(start + depth + LEN <= self.lower.len() && column + N <= depth);
            // SAFETY: `start` is the start of the row of a descendant of the supernode, which by construction of the
            // tree has more than `depth + LEN` entries, and `lower` and `scaled` extend to its end. The checks were
            // half of the instructions of this loop, the hottest of all.
            unsafe {
                for m in 0..LEN {
                    let multiplier = *self.lower.get_unchecked(start + depth + m);
                    for c in 0..N {
                        sums[m][c] -= multiplier * *self.scaled.get_unchecked(start + column + c);
                    }
                }
            }
        }
        sums
    }

    /// Returns the same for the supernode's own columns, of which row m has the first m + 1.
    #[inline(always)]
    fn block<const LEN: usize>(&self, depth: usize, rows: &[&[T]; LEN]) -> [[T; LEN]; LEN] {
        let mut sums = [[T::ZERO; LEN]; LEN];
        for m in 0..LEN {
            for j in 0..=m {
                sums[m][j] = rows[m][depth + j];
            }
        }
        for &start in self.rows.iter().rev() {
            let start = start as usize - self.offset + depth;
            let (lower, scaled) = (&self.lower[start..][..LEN], &self.scaled[start..][..LEN]);
            for m in 0..LEN {
                for j in 0..=m {
                    sums[m][j] -= lower[m] * scaled[j];
                }
            }
        }
        sums
    }
}

/// The output for the columns of a supernode's ancestors, and the finished part of its rows.
struct Columns<'a, T, const LEN: usize> {
    depth: usize,
    starts: [usize; LEN],
    block: &'a [[T; LEN]; LEN],
    inverse: &'a [T; LEN],
    lower: &'a mut [T],
    scaled: &'a mut [T],
}

impl<T: Real, const LEN: usize> Columns<'_, T, LEN> {
    /// Computes all columns, a few at a time.
    #[inline(always)]
    fn fill(&mut self, below: &Below<T>, rows: &[&[T]; LEN]) {
        let depth = self.depth;
        match depth {
            0 => {}
            1 => self.write::<1>(0, below.window(depth, 0, rows)),
            2 => self.write::<2>(0, below.window(depth, 0, rows)),
            3 => self.write::<3>(0, below.window(depth, 0, rows)),
            _ => {
                for column in (0..=depth - WIDTH).step_by(WIDTH) {
                    self.write::<WIDTH>(column, below.window(depth, column, rows));
                }
                // The last columns, some possibly computed twice.
                if !depth.is_multiple_of(WIDTH) {
                    let column = depth - WIDTH;
                    self.write::<WIDTH>(column, below.window(depth, column, rows));
                }
            }
        }
    }

    /// Subtracts the contributions of the supernode's later rows, and writes `N` columns from `column` on.
    #[inline(always)]
    fn write<const N: usize>(&mut self, column: usize, mut sums: [[T; N]; LEN]) {
        for m in (0..LEN).rev() {
            for k in (m + 1..LEN).rev() {
                let multiplier = self.block[k][m] * self.inverse[k];
                for c in 0..N {
                    sums[m][c] -= multiplier * sums[k][c];
                }
            }
            let start = self.starts[m] + column;
            debug_assert!(column + N <= self.depth);
            for (c, &sum) in sums[m].iter().enumerate() {
                self.scaled[start + c] = sum;
                self.lower[start + c] = sum * self.inverse[m];
            }
        }
    }
}
