//! A symmetric matrix in the pattern of a tree.

use super::{Tree, TreeSupernode, with_len};
use clench_math::{Real, array, kernel};

/// A symmetric matrix in the pattern of a [`Tree`]: its lower triangle, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeMatrix<T> {
    /// Row i: ancestors ascending, diagonal last (MuJoCo's compressed lower triangle). Length `tree.nnz()`.
    pub values: Vec<T>,
}

impl<T: Real> TreeMatrix<T> {
    /// Creates the zero matrix.
    pub fn zeros(tree: &Tree) -> Self {
        TreeMatrix {
            values: vec![T::ZERO; tree.nnz()],
        }
    }
    /// Returns the stored values of row `i`.
    #[inline(always)]
    pub fn row<'a>(&'a self, tree: &Tree, i: usize) -> &'a [T] {
        &self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// Returns the stored values of row `i` for writing.
    #[inline(always)]
    pub fn row_mut<'a>(&'a mut self, tree: &Tree, i: usize) -> &'a mut [T] {
        &mut self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// Computes `out = A x`.
    #[kernel]
    pub fn mul(&self, tree: &Tree, x: &[T], out: &mut [T]) {
        for &TreeSupernode { first, len } in &tree.supernodes {
            with_len!(len, LEN => self.mul_supernode::<LEN>(tree, first, x, out));
        }
    }
    #[inline(always)]
    fn mul_supernode<const LEN: usize>(&self, tree: &Tree, first: usize, x: &[T], out: &mut [T]) {
        let shared = &tree.row(first)[..tree.depth(first)];
        let rows: [&[T]; LEN] = tree.supernode_rows(&self.values, first);
        let own: [T; LEN] = array(|m| x[first + m]);
        let mut sums: [T; LEN] = array(|m| rows[m][shared.len() + m] * own[m]);
        for (k, &c) in shared.iter().enumerate() {
            let (x, mut sum) = (x[c as usize], out[c as usize]);
            for m in 0..LEN {
                sums[m] += rows[m][k] * x;
                sum += rows[m][k] * own[m];
            }
            out[c as usize] = sum;
        }
        for m in 1..LEN {
            for j in 0..m {
                let value = rows[m][shared.len() + j];
                sums[m] += value * own[j];
                sums[j] += value * own[m];
            }
        }
        out[first..first + LEN].copy_from_slice(&sums);
    }
    /// Returns all nv × nv entries, row-major.
    pub fn to_dense(&self, tree: &Tree) -> Vec<T> {
        let nv = tree.nv();
        let mut dense = vec![T::ZERO; nv * nv];
        for i in 0..nv {
            for (&c, &v) in tree.row(i).iter().zip(self.row(tree, i)) {
                dense[i * nv + c as usize] = v;
                dense[c as usize * nv + i] = v;
            }
        }
        dense
    }
}
