//! Subtracts the contributions of a finished supernode from rows of one above it, in tiles that stay in registers.

use super::pattern::{Run, Supernode};
use clench_math::{Real, array};

/// The number of columns of a tile: those of one free body, and of two.
pub(super) const NARROW: usize = 6;
const WIDE: usize = 12;

/// A finished supernode, and one above it.
pub(super) struct Tiles<'a, T> {
    /// L and U of the finished supernode, the number of its rows and their length.
    pub lower: &'a [T],
    pub upper: &'a [T],
    pub len: usize,
    pub width: usize,
    /// The block of the supernode above.
    pub above: &'a mut [T],
    pub target: &'a Supernode,
}

/// Rows of the supernode above.
pub(super) struct Rows<'a> {
    pub dofs: &'a [u32],
    /// The index of the first in the columns of the finished supernode.
    pub offset: usize,
}

impl<T: Real> Tiles<'_, T> {
    /// Subtracts the contributions of the finished supernode from some rows, up to their diagonal. To the right of the
    /// diagonal nothing is stored; values written there are never read.
    #[inline(always)]
    pub(super) fn subtract(&mut self, rows: &Rows, runs: &[Run], target_runs: &[Run]) {
        let last = rows.offset + rows.dofs.len();
        let mut candidates = target_runs.iter();
        let mut candidate = candidates.next();
        for run in runs {
            let (offset, dof) = (run.offset as usize, run.dof as usize);
            if offset >= last {
                break;
            }
            let to = if dof >= self.target.first {
                self.target.shared() + dof - self.target.first
            } else {
                while candidate.is_some_and(|c| ((c.dof + c.len) as usize) <= dof) {
                    candidate = candidates.next();
                }
                let Some(found) = candidate else { break };
                found.offset as usize + dof - found.dof as usize
            };
            let len = (run.len as usize).min(last - offset);
            self.subtract_run(rows, offset, len, to);
        }
    }

    /// Does the same for `len` columns from `offset` on, which start at `to` in the rows of the target.
    #[inline(always)]
    fn subtract_run(&mut self, rows: &Rows, offset: usize, len: usize, to: usize) {
        let mut column = 0;
        while column < len {
            let (from, to) = (offset + column, to + column);
            column += match len - column {
                // As many columns as fit into registers: more for scalars than for lanes.
                WIDE.. if T::LANES == 1 => self.subtract_columns::<WIDE>(rows, from, to),
                NARROW.. => self.subtract_columns::<NARROW>(rows, from, to),
                2.. => self.subtract_columns::<2>(rows, from, to),
                _ => self.subtract_columns::<1>(rows, from, to),
            };
        }
    }

    /// Does the same for N columns; returns N.
    #[inline(always)]
    fn subtract_columns<const N: usize>(&mut self, rows: &Rows, from: usize, to: usize) -> usize {
        let mut row = 0;
        while row + 3 <= rows.dofs.len() {
            self.subtract_tile::<3, N>(rows, row, from, to);
            row += 3;
        }
        while row < rows.dofs.len() {
            self.subtract_tile::<1, N>(rows, row, from, to);
            row += 1;
        }
        N
    }

    /// Does the same for R rows and N columns.
    #[inline(always)]
    fn subtract_tile<const R: usize, const N: usize>(
        &mut self,
        rows: &Rows,
        row: usize,
        from: usize,
        to: usize,
    ) {
        let starts: [usize; R] = array(|r| {
            let m = rows.dofs[row + r] as usize - self.target.first;
            m * self.target.width() + to
        });
        let mut sums = [[T::ZERO; N]; R];
        for r in 0..R {
            sums[r].copy_from_slice(&self.above[starts[r]..starts[r] + N]);
        }
        let multipliers = rows.offset + row;
        for k in (0..self.len).rev() {
            let start = k * self.width;
            let lower = &self.lower[start + multipliers..][..R];
            let upper = &self.upper[start + from..][..N];
            for r in 0..R {
                for c in 0..N {
                    sums[r][c] -= lower[r] * upper[c];
                }
            }
        }
        for r in 0..R {
            self.above[starts[r]..starts[r] + N].copy_from_slice(&sums[r]);
        }
    }
}
