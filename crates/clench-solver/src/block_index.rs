//! The location of a block's data.

use crate::costs::Cost;
use std::ops::Range;

/// The location of a block in the pools.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlockIndex {
    pub cost: Cost,
    pub dim: usize,
    pub ndof: usize,
    /// The first row, first dof entry, first Jacobian value and first entry of the active set.
    pub row: usize,
    pub dof: usize,
    pub value: usize,
    pub active_start: usize,
}

impl BlockIndex {
    /// Returns its rows.
    #[inline(always)]
    pub(crate) fn rows(&self) -> Range<usize> {
        self.row..self.row + self.dim
    }

    /// Returns its entries of the active set.
    #[inline(always)]
    pub(crate) fn active_range(&self) -> Range<usize> {
        self.active_start..self.active_start + crate::costs::active_len(self.cost, self.dim)
    }
}
