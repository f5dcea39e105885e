//! Solves with the factor, supernode by supernode.

use super::factor::SparseFactor;
use super::pattern::{SparsePattern, Supernode};
use clench_math::{Real, array, kernel};

impl<T: Real> SparseFactor<T> {
    /// Computes `x ← A⁻¹ x`.
    #[inline(always)]
    pub(crate) fn solve(&mut self, pattern: &SparsePattern, x: &mut [T]) {
        self.solve_transposed(pattern, x);
        self.complete_solve(pattern, x);
    }

    /// Computes `x ← L^(-T) x`.
    #[kernel]
    pub(crate) fn solve_transposed(&mut self, pattern: &SparsePattern, x: &mut [T]) {
        for s in pattern.supernodes() {
            self.solve_transposed_rows(pattern, s, x);
        }
    }

    /// Computes `x ← L⁻¹ D⁻¹ x`, which completes [`solve_transposed`](Self::solve_transposed).
    #[kernel]
    pub(crate) fn complete_solve(&mut self, pattern: &SparsePattern, x: &mut [T]) {
        for (x, &inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= inverse;
        }
        for s in pattern.supernodes().iter().rev() {
            self.solve_rows(pattern, s, x);
        }
    }

    /// Computes `x ← L^(-T) x` for pairs x that are zero outside the path to dof `last`, then divides the first of each
    /// pair by D. Calls `put` with each dof of the path, from the last, and sets its entry to zero.
    #[inline(always)]
    pub(crate) fn solve_pairs_along(
        &self,
        pattern: &SparsePattern,
        last: usize,
        x: &mut [[T; 2]],
        mut put: impl FnMut(u32, [T; 2]),
    ) {
        let mut next = Some(last);
        while let Some(dof) = next {
            let s = pattern.supernode_of(dof);
            let columns = pattern.columns_of_row(s, dof);
            next = columns.clone().next_back().map(|c| c as usize);
            let [first, second] = std::mem::replace(&mut x[dof], [T::ZERO; 2]);
            for (&l, column) in self.values[s.row(dof)].iter().zip(columns) {
                let x = &mut x[column as usize];
                x[0] -= l * first;
                x[1] -= l * second;
            }
            put(dof as u32, [first * self.inverse[dof], second]);
        }
    }

    /// Subtracts the contributions of a supernode's rows, of which the rows below are done, from the rows above.
    #[inline(always)]
    fn solve_transposed_rows(&mut self, pattern: &SparsePattern, s: &Supernode, x: &mut [T]) {
        let (width, shared) = (s.width(), s.shared());
        self.gather(pattern.columns(s), x);
        let gathered = &mut self.gathered[..];
        let block = &self.values[s.block()];
        for (m, row) in block.chunks_exact(width).enumerate().rev() {
            let (row, own_row) = row.split_at(shared);
            let (before, own) = x[s.first..].split_at_mut(m);
            for (x, &l) in before.iter_mut().zip(own_row) {
                *x -= l * own[0];
            }
            for (x, &l) in gathered.iter_mut().zip(row) {
                *x -= l * own[0];
            }
        }
        for (&x_of, &dof) in gathered.iter().zip(pattern.columns(s)) {
            x[dof as usize] = x_of;
        }
    }

    /// Computes `x ← L⁻¹ x` in the rows of a supernode, once the rows above are done.
    #[inline(always)]
    fn solve_rows(&mut self, pattern: &SparsePattern, s: &Supernode, x: &mut [T]) {
        let (width, shared) = (s.width(), s.shared());
        self.gather(pattern.columns(s), x);
        let block = &self.values[s.block()];
        // Several sums run in parallel, since each depends on its own last term.
        let mut m = 0;
        while m < s.len {
            let count = if s.len - m >= SUMS { SUMS } else { 1 };
            let own = &mut x[s.first + m..][..count];
            let rows = &block[m * width..];
            match count {
                SUMS => subtract_products::<T, SUMS>(own, rows, width, &self.gathered),
                _ => subtract_products::<T, 1>(own, rows, width, &self.gathered),
            }
            m += count;
        }
        for m in 1..s.len {
            let row = &block[m * width + shared..][..m];
            let (before, own) = x[s.first..].split_at_mut(m);
            for (&x, &l) in before.iter().zip(row) {
                own[0] -= l * x;
            }
        }
    }

    #[inline(always)]
    fn gather(&mut self, columns: &[u32], x: &[T]) {
        self.gathered.clear();
        self.gathered
            .extend(columns.iter().map(|&dof| x[dof as usize]));
    }
}

/// The number of sums that run in parallel in a solve.
const SUMS: usize = 6;

/// Computes `own −= rows · x` for N rows.
#[inline(always)]
fn subtract_products<T: Real, const N: usize>(own: &mut [T], rows: &[T], width: usize, x: &[T]) {
    let mut sums: [T; N] = array(|m| own[m]);
    let rows: [&[T]; N] = array(|m| &rows[m * width..][..x.len()]);
    for (k, &x) in x.iter().enumerate() {
        for m in 0..N {
            sums[m] -= rows[m][k] * x;
        }
    }
    own.copy_from_slice(&sums);
}
