//! Solves with the factor, supernode by supernode or along one path.

use super::{Tree, TreeFactor, TreeSupernode, with_len};
use clench_math::{Real, array, kernel};

impl<T: Real> TreeFactor<T> {
    /// Computes `x ← A⁻¹ x`.
    #[inline(always)]
    pub fn solve(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        self.complete_solve(tree, x);
    }

    /// Computes `x ← L⁻¹ D⁻¹ x`, which completes [`solve_transposed`](Self::solve_transposed).
    #[kernel]
    pub(crate) fn complete_solve(&self, tree: &Tree, x: &mut [T]) {
        for &TreeSupernode { first, len } in &tree.supernodes {
            with_len!(len, LEN => self.solve_supernode::<LEN>(tree, first, x));
        }
    }

    /// Computes `x ← L⁻¹ D⁻¹ x` in the rows of a supernode whose ancestors are done.
    #[inline(always)]
    fn solve_supernode<const LEN: usize>(&self, tree: &Tree, first: usize, x: &mut [T]) {
        let shared = &tree.row(first)[..tree.depth(first)];
        let rows: [&[T]; LEN] = tree.supernode_rows(&self.lower, first);
        let mut sums: [T; LEN] = array(|m| x[first + m] * self.inverse[first + m]);
        for (k, &c) in shared.iter().enumerate() {
            let x = x[c as usize];
            for m in 0..LEN {
                sums[m] -= rows[m][k] * x;
            }
        }
        for m in 1..LEN {
            for j in 0..m {
                sums[m] -= rows[m][shared.len() + j] * sums[j];
            }
        }
        x[first..first + LEN].copy_from_slice(&sums);
    }

    /// Computes `x ← D^(-1/2) L^(-T) x`: afterwards `x·y` is the product `xᵀA⁻¹y` of the inputs.
    #[kernel]
    pub fn solve_half(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        for (x, &inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= inverse.sqrt();
        }
    }

    /// Computes the same as [`solve_half`](Self::solve_half), to the bit, for an x that is zero outside the path to dof
    /// `last`. `x` holds the entries on the path, in the order of `tree.row(last)`.
    pub fn solve_half_along(&self, tree: &Tree, last: usize, x: &mut [T]) {
        let path = tree.row(last);
        for (count, &dof) in path.iter().enumerate().rev() {
            let row = &self.lower[tree.row_start(dof as usize)..][..count];
            let (above, own) = x.split_at_mut(count);
            for (above, &multiplier) in above.iter_mut().zip(row) {
                *above -= multiplier * own[0];
            }
        }
        for (x, &dof) in x.iter_mut().zip(path) {
            *x *= self.inverse[dof as usize].sqrt();
        }
    }

    /// Computes `x ← L^(-T) x` for pairs x that are zero outside the path to dof `last`, then divides the first of each
    /// pair by D. `x` holds the entries on the path, in the order of `tree.row(last)`.
    #[inline(always)]
    pub(crate) fn solve_pairs_along(&self, tree: &Tree, last: usize, x: &mut [[T; 2]]) {
        for (count, &dof) in tree.row(last).iter().enumerate().rev() {
            let row = &self.lower[tree.row_start(dof as usize)..][..count];
            let (above, own) = x.split_at_mut(count);
            let [first, second] = &mut own[0];
            for (above, &multiplier) in above.iter_mut().zip(row) {
                above[0] -= multiplier * *first;
                above[1] -= multiplier * *second;
            }
            *first *= self.inverse[dof as usize];
        }
    }

    /// Computes `x ← L^(-T) x`.
    #[kernel]
    pub(crate) fn solve_transposed(&self, tree: &Tree, x: &mut [T]) {
        for &TreeSupernode { first, len } in tree.supernodes.iter().rev() {
            with_len!(len, LEN => self.solve_transposed_supernode::<LEN>(tree, first, x));
        }
    }

    /// Subtracts the contributions of the rows of a supernode, whose descendants are done, from their ancestors.
    #[inline(always)]
    fn solve_transposed_supernode<const LEN: usize>(&self, tree: &Tree, first: usize, x: &mut [T]) {
        let shared = &tree.row(first)[..tree.depth(first)];
        let rows: [&[T]; LEN] = tree.supernode_rows(&self.lower, first);
        let mut own: [T; LEN] = array(|m| x[first + m]);
        for m in (1..LEN).rev() {
            for j in 0..m {
                own[j] -= rows[m][shared.len() + j] * own[m];
            }
        }
        x[first..first + LEN].copy_from_slice(&own);
        for (k, &c) in shared.iter().enumerate() {
            let mut value = x[c as usize];
            for m in (0..LEN).rev() {
                value -= rows[m][k] * own[m];
            }
            x[c as usize] = value;
        }
    }
}
