//! The sparsity pattern of a matrix over dofs.

use std::ops::Range;

/// The dofs of each row of a sparse matrix over dofs, ascending, without duplicates. The entries of all rows are stored
/// row after row in a separate array.
#[derive(Clone, Debug, Default)]
pub struct RowPattern {
    dofs: Vec<u32>,
    ends: Vec<usize>,
}

impl RowPattern {
    /// Appends a row that may be nonzero at `dofs`, in any order and possibly with duplicates.
    pub fn push(&mut self, dofs: impl IntoIterator<Item = u32>) {
        let start = self.dofs.len();
        self.dofs.extend(dofs);
        self.dofs[start..].sort_unstable();
        let mut kept = start;
        for i in start..self.dofs.len() {
            if i == start || self.dofs[i] != self.dofs[kept - 1] {
                self.dofs[kept] = self.dofs[i];
                kept += 1;
            }
        }
        self.dofs.truncate(kept);
        self.ends.push(kept);
    }

    /// Returns the number of entries.
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// Returns true if no row has an entry.
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// Returns the dofs of all rows.
    pub(crate) fn all_dofs(&self) -> &[u32] {
        &self.dofs
    }

    /// Returns the range of the entries of a row.
    #[inline(always)]
    pub fn range(&self, row: usize) -> Range<usize> {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[row]
    }

    /// Returns the dofs of a row.
    #[inline(always)]
    pub fn dofs(&self, row: usize) -> &[u32] {
        &self.dofs[self.range(row)]
    }

    /// Returns the dofs of a row with their entries; `entries` are those of all rows.
    #[inline(always)]
    pub fn row<'a, T: Copy>(
        &'a self,
        entries: &'a [T],
        row: usize,
    ) -> impl Iterator<Item = (usize, T)> + Clone + 'a {
        let dofs = self.dofs(row).iter().map(|&dof| dof as usize);
        dofs.zip(entries[self.range(row)].iter().copied())
    }
}
