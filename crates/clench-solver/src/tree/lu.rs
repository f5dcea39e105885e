//! A nonsymmetric matrix in the symmetric pattern of a tree, and its factorization without fill.
//!
//! Elimination runs from the last row to the first, as for LᵀDL: A = U L with U unit upper and L lower triangular.
//! Subtracting row k from the rows above changes only entries between ancestors of k, which are in the pattern. There
//! is no pivoting: a pivot vanishes only if a principal minor does, and A is a mass matrix plus a small term.

use super::Tree;
use clench_math::{Mask, Real, kernel};

/// A square matrix with the pattern of a [`Tree`] in both triangles; [`factor`](Self::factor) replaces it by its
/// factors.
#[derive(Clone, Debug, Default)]
pub struct TreeLu<T> {
    /// Row i of the lower triangle: ancestors ascending, diagonal last.
    pub lower: Vec<T>,
    /// Column i of the upper triangle, likewise; its diagonal is not used.
    pub upper: Vec<T>,
}

impl<T: Real> TreeLu<T> {
    /// Creates the zero matrix.
    pub fn zeros(tree: &Tree) -> Self {
        TreeLu {
            lower: vec![T::ZERO; tree.nnz()],
            upper: vec![T::ZERO; tree.nnz()],
        }
    }

    /// Returns row `i` of the lower triangle and column `i` of the upper one for writing.
    #[inline(always)]
    pub fn dof_mut<'a>(&'a mut self, tree: &Tree, i: usize) -> (&'a mut [T], &'a mut [T]) {
        let range = tree.starts[i]..tree.starts[i + 1];
        (&mut self.lower[range.clone()], &mut self.upper[range])
    }

    /// Computes `out = A x` with the matrix before it is factored.
    #[kernel]
    pub fn mul(&self, tree: &Tree, x: &[T], out: &mut [T]) {
        for k in 0..tree.nv() {
            let (start, chain) = (tree.starts[k], tree.row(k));
            let depth = chain.len() - 1;
            let mut sum = self.lower[start + depth] * x[k];
            for (p, &i) in chain[..depth].iter().enumerate() {
                let i = i as usize;
                sum += self.lower[start + p] * x[i];
                out[i] += self.upper[start + p] * x[k];
            }
            out[k] = sum;
        }
    }

    /// Replaces the matrix by its factors. Returns false in lanes with a pivot that is zero or not finite.
    #[kernel]
    pub fn factor(&mut self, tree: &Tree) -> T::Mask {
        let mut regular = T::Mask::splat(true);
        for k in (0..tree.nv()).rev() {
            let (start, chain) = (tree.starts[k], tree.row(k));
            let depth = chain.len() - 1;
            let pivot = self.lower[start + depth];
            regular &= pivot.abs().gt(T::ZERO) & pivot.is_finite();
            for (p, &i) in chain[..depth].iter().enumerate() {
                let multiplier = self.upper[start + p] / pivot;
                self.upper[start + p] = multiplier;
                // The row of k is stored after those of its ancestors.
                let (above, below) = self.lower.split_at_mut(start);
                let row = &mut above[tree.starts[i as usize]..];
                for (entry, &own) in row.iter_mut().zip(&below[..=p]) {
                    *entry -= multiplier * own;
                }
                for (q, &j) in chain[..depth].iter().enumerate().skip(p + 1) {
                    let column = tree.starts[j as usize];
                    self.upper[column + p] -= multiplier * self.lower[start + q];
                }
            }
        }
        regular
    }

    /// Replaces b by the solution x of A x = b.
    #[kernel]
    pub fn solve(&self, tree: &Tree, x: &mut [T]) {
        for k in (0..tree.nv()).rev() {
            let (start, chain) = (tree.starts[k], tree.row(k));
            for (p, &i) in chain[..chain.len() - 1].iter().enumerate() {
                x[i as usize] -= self.upper[start + p] * x[k];
            }
        }
        for k in 0..tree.nv() {
            let (start, chain) = (tree.starts[k], tree.row(k));
            let depth = chain.len() - 1;
            let mut rest = x[k];
            for (p, &i) in chain[..depth].iter().enumerate() {
                rest -= self.lower[start + p] * x[i as usize];
            }
            x[k] = rest / self.lower[start + depth];
        }
    }
}
