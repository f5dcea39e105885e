//! A subset of the rows of a [`SparsePattern`], so that threads can write a matrix in parallel.

use super::pattern::{SparsePattern, Supernode};
use crate::jacobian::{Part, Pattern};
use crate::tree::{Tree, TreeMatrix};
use clench_math::{Real, kernel};
use std::ops::Range;

/// Consecutive supernodes, whose values are contiguous.
#[derive(Clone)]
pub(crate) struct Window<'a> {
    pattern: &'a SparsePattern,
    supernodes: Range<usize>,
    /// The dofs; rows are eliminated from the last to the first.
    dofs: Range<u32>,
    /// The offset of their values in those of the pattern.
    offset: usize,
}

impl<'a> Window<'a> {
    /// Returns a window of all rows of a pattern.
    pub(crate) fn whole(pattern: &'a SparsePattern) -> Self {
        Window::new(pattern, 0..pattern.supernodes().len())
    }

    /// Returns a window of some supernodes of a pattern.
    fn new(pattern: &'a SparsePattern, supernodes: Range<usize>) -> Self {
        let dofs = match &pattern.supernodes()[supernodes.clone()] {
            [] => 0..0,
            [first, .., last] => last.first..first.first + first.len,
            [only] => only.first..only.first + only.len,
        };
        let first = pattern.supernodes().get(supernodes.start);
        Window {
            pattern,
            dofs: dofs.start as u32..dofs.end as u32,
            offset: first.map_or(pattern.nnz(), |s| s.start),
            supernodes,
        }
    }

    /// Splits the window in two, the first with `part` of `whole` equal parts of the supernodes.
    pub(crate) fn split(self, part: usize, whole: usize) -> (Self, Self) {
        let Range { start, end } = self.supernodes;
        let middle = start + (end - start) * part / whole;
        let of = |supernodes| Window::new(self.pattern, supernodes);
        (of(start..middle), of(middle..end))
    }

    /// Returns the number of stored values.
    pub(crate) fn len(&self) -> usize {
        let blocks = self.pattern.supernodes()[self.supernodes.clone()].iter();
        blocks.map(|s| s.block().len()).sum()
    }

    /// Writes into `values` a matrix over `tree`, whose entries the pattern contains.
    #[kernel]
    pub fn set_matrix<T: Real>(&self, tree: &Tree, matrix: &TreeMatrix<T>, values: &mut [T]) {
        values.fill(T::ZERO);
        for dof in self.dofs.start..self.dofs.end {
            let (columns, row) = (tree.row(dof as usize), matrix.row(tree, dof as usize));
            let (s, start) = self.row(dof);
            let mut first = 0;
            while first < columns.len() {
                let len = run_length(&columns[first..]);
                let offset = start + self.pattern.row_of_column(s, columns[first] as usize);
                values[offset..offset + len].copy_from_slice(&row[first..first + len]);
                first += len;
            }
        }
    }

    /// Returns the supernode of a row, and the start of the row.
    #[inline(always)]
    fn row(&self, dof: u32) -> (&'a Supernode, usize) {
        let s = self.pattern.supernode_of(dof as usize);
        let start = s.start - self.offset + (dof as usize - s.first) * s.width();
        (s, start)
    }
}

/// Returns the length of the leading run of consecutive dofs.
#[inline(always)]
fn run_length(dofs: &[u32]) -> usize {
    1 + dofs
        .windows(2)
        .take_while(|pair| pair[1] == pair[0] + 1)
        .count()
}

impl Pattern for Window<'_> {
    #[inline(always)]
    fn holds_any(&self, dofs: &[u32]) -> bool {
        let (Some(first), Some(&last)) = (dofs.first(), dofs.last()) else {
            return false;
        };
        // The first and last dof decide most blocks.
        last >= self.dofs.start
            && *first < self.dofs.end
            && (self.dofs.contains(&last) || dofs.iter().any(|dof| self.dofs.contains(dof)))
    }

    #[inline(always)]
    fn each_part(&self, dofs: &[u32], mut act: impl FnMut(&Part)) {
        let mut row = 0;
        while row < dofs.len() {
            let s = self.pattern.supernode_of(dofs[row] as usize);
            let left = s.first + s.len - dofs[row] as usize;
            let rows = row..row + run_length(&dofs[row..]).min(left);
            if self.dofs.contains(&dofs[row]) {
                let (s, start) = self.row(dofs[row]);
                let mut column = 0;
                while column < rows.end {
                    let own = column == row;
                    let end = match own {
                        true => rows.end,
                        // Consecutive columns are adjacent.
                        false => column + run_length(&dofs[column..row]),
                    };
                    act(&Part {
                        rows: rows.clone(),
                        columns: column..end,
                        triangle: own,
                        offset: start + self.pattern.row_of_column(s, dofs[column] as usize),
                        stride: s.width(),
                    });
                    column = end;
                }
            }
            row = rows.end;
        }
    }
}
