//! Pairs of vectors that are zero outside a path of the elimination tree.

use clench_math::Real;
use std::ops::Range;

/// Pairs of vectors, each with the entries of both at the dofs of a path, from its root.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathPairs<T> {
    dofs: Vec<u32>,
    entries: Vec<[T; 2]>,
    /// The end of each pair.
    ends: Vec<usize>,
}

impl<T: Real> PathPairs<T> {
    pub(crate) fn clear(&mut self) {
        self.dofs.clear();
        self.entries.clear();
        self.ends.clear();
    }

    /// Appends a pair of zero vectors on a path; returns its entries.
    #[inline(always)]
    pub(super) fn push_zeros(&mut self, path: &[u32]) -> &mut [[T; 2]] {
        let start = self.dofs.len();
        self.dofs.extend_from_slice(path);
        self.entries.resize(self.dofs.len(), [T::ZERO; 2]);
        self.end();
        &mut self.entries[start..]
    }

    /// Appends an entry of an unfinished pair, at the next dof towards the root.
    #[inline(always)]
    pub(super) fn push_entry(&mut self, dof: u32, entry: [T; 2]) {
        self.dofs.push(dof);
        self.entries.push(entry);
    }

    /// Ends a pair whose entries are complete.
    #[inline(always)]
    pub(super) fn end(&mut self) {
        self.ends.push(self.dofs.len());
    }

    /// Ends a pair whose entries were appended from the last dof to the root.
    #[inline(always)]
    pub(super) fn end_reversed(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        self.dofs[start..].reverse();
        self.entries[start..].reverse();
        self.end();
    }

    /// Computes the product of the first vector of pair `i` with the second of pair `j`, over their common path.
    #[inline(always)]
    pub(crate) fn product(&self, i: usize, j: usize) -> T {
        let (first, second) = (self.range(i), self.range(j));
        let dofs = self.dofs[first.clone()]
            .iter()
            .zip(&self.dofs[second.clone()]);
        let common = dofs.take_while(|(dof, other)| dof == other).count();
        let mut sum = T::ZERO;
        for (x, y) in self.entries[first][..common]
            .iter()
            .zip(&self.entries[second])
        {
            sum += x[0] * y[1];
        }
        sum
    }

    /// Computes the product of the first vector of pair `i` with `x`.
    #[inline(always)]
    pub(crate) fn product_with(&self, i: usize, x: &[T]) -> T {
        let mut sum = T::ZERO;
        for (&dof, entry) in self.dofs[self.range(i)]
            .iter()
            .zip(&self.entries[self.range(i)])
        {
            sum += entry[0] * x[dof as usize];
        }
        sum
    }

    /// Computes `x += scale · y` with the second vector y of pair `i`.
    #[inline(always)]
    pub(crate) fn add_second(&self, i: usize, scale: T, x: &mut [T]) {
        for (&dof, entry) in self.dofs[self.range(i)]
            .iter()
            .zip(&self.entries[self.range(i)])
        {
            x[dof as usize] += scale * entry[1];
        }
    }

    #[inline(always)]
    fn range(&self, i: usize) -> Range<usize> {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[i]
    }
}
