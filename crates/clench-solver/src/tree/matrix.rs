//! A symmetric matrix in the pattern of a tree.

use super::Tree;
use clench_math::{Real, kernel};

/// A symmetric matrix in the pattern of a [`Tree`]: its lower triangle, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeMatrix<T> {
    /// Row i: ancestors ascending, diagonal last (MuJoCo's compressed lower triangle). Length `tree.nnz()`.
    pub values: Vec<T>,
}

impl<T: Real> TreeMatrix<T> {
    /// The zero matrix.
    pub fn zeros(tree: &Tree) -> Self {
        TreeMatrix {
            values: vec![T::ZERO; tree.nnz()],
        }
    }
    /// The stored values of row `i`.
    #[inline(always)]
    pub fn row<'a>(&'a self, tree: &Tree, i: usize) -> &'a [T] {
        &self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// The stored values of row `i`, to be written.
    #[inline(always)]
    pub fn row_mut<'a>(&'a mut self, tree: &Tree, i: usize) -> &'a mut [T] {
        &mut self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// `out = A x`.
    #[kernel]
    pub fn mul(&self, tree: &Tree, x: &[T], out: &mut [T]) {
        for i in 0..tree.nv() {
            let (first, lead, others) = tree.split_row(i);
            let row = self.row(tree, i);
            let xi = x[i];
            let mut sum = row[row.len() - 1] * xi;
            for ((&v, &x), out) in row
                .iter()
                .zip(&x[first..first + lead])
                .zip(&mut out[first..first + lead])
            {
                sum += v * x;
                *out += v * xi;
            }
            for (&v, &c) in row[lead..].iter().zip(others) {
                sum += v * x[c as usize];
                out[c as usize] += v * xi;
            }
            out[i] = sum;
        }
    }
    /// All nv × nv entries, row-major.
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
