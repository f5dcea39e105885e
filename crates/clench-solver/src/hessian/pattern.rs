//! Which entries of the factored Hessian can be nonzero.
//!
//! Rows are kept as bit sets while the pattern is built. Eliminating row j spreads its columns below j to each row that
//! it touches; it is enough to hand them to the largest of these, p, since p passes them on: `row[p] |= row[j] < p`.
//! A branch of a tree is closed under this from the start, so only couplings between branches can fill.

use crate::Tree;
use crate::jacobian::BlockIndex;

/// Columns are handled in tiles of this many: one or a few registers, so that a short row costs few instructions.
pub(crate) const TILE: usize = 4;

/// The nonzero structure of L, by rows (as tiles) and by columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pattern {
    nv: usize,
    dense: bool,
    /// Which tree this belongs to: its parents.
    parents: Vec<Option<usize>>,
    /// The couplings that are not within a branch: each a count and its dofs.
    couplings: Vec<u32>,
    /// Those of the problem at hand.
    found: Vec<u32>,
    /// One bit set a row, `words` long.
    bits: Vec<u64>,
    words: usize,
    /// First value of each row; rows are padded to whole tiles.
    row_starts: Vec<usize>,
    /// Tiles of row i: `tiles[tile_starts[i]..tile_starts[i + 1]]`, ascending, each by its first column.
    tiles: Vec<u32>,
    tile_starts: Vec<usize>,
    /// Rows k > i with an entry in column i, ascending.
    below: Vec<u32>,
    below_starts: Vec<usize>,
}

impl Pattern {
    /// Makes the pattern that of `tree` with the couplings of `blocks`; true if that changed it.
    pub fn prepare(
        &mut self,
        tree: &Tree,
        dense: bool,
        blocks: &[BlockIndex],
        dofs: &[u32],
    ) -> bool {
        let same_tree = self.nv == tree.nv()
            && self.dense == dense
            && (0..self.nv).all(|i| self.parents[i] == tree.parent(i));
        self.found.clear();
        if !dense {
            for b in blocks {
                let dofs = &dofs[b.dof..b.dof + b.ndof];
                if !within_branch(tree, dofs) {
                    self.found.push(dofs.len() as u32);
                    self.found.extend_from_slice(dofs);
                }
            }
        }
        if same_tree && !self.row_starts.is_empty() && self.couplings == self.found {
            return false;
        }
        self.couplings.clear();
        self.couplings.extend_from_slice(&self.found);
        self.dense = dense;
        self.parents.clear();
        self.parents.extend((0..tree.nv()).map(|i| tree.parent(i)));
        self.set_bits(tree);
        self.eliminate();
        self.list();
        true
    }

    fn set_bits(&mut self, tree: &Tree) {
        self.nv = tree.nv();
        self.words = self.nv.div_ceil(64);
        self.bits.clear();
        self.bits.resize(self.nv * self.words, 0);
        for i in 0..self.nv {
            if self.dense {
                (0..=i).for_each(|c| self.set(i, c));
            } else {
                tree.row(i).iter().for_each(|&c| self.set(i, c as usize));
            }
        }
        let mut at = 0;
        while at < self.couplings.len() {
            let end = at + 1 + self.couplings[at] as usize;
            for k in at + 1..end {
                for c in at + 1..=k {
                    self.set(self.couplings[k] as usize, self.couplings[c] as usize);
                }
            }
            at = end;
        }
    }

    fn set(&mut self, row: usize, column: usize) {
        self.bits[row * self.words + column / 64] |= 1 << (column % 64);
    }

    fn has(&self, row: usize, column: usize) -> bool {
        self.bits[row * self.words + column / 64] >> (column % 64) & 1 == 1
    }

    fn eliminate(&mut self) {
        for j in (1..self.nv).rev() {
            // All columns of row j other than the diagonal are below j; p is their largest.
            let Some(p) = (0..j).rev().find(|&c| self.has(j, c)) else {
                continue;
            };
            let (target, source) = self.bits.split_at_mut(j * self.words);
            let target = &mut target[p * self.words..(p + 1) * self.words];
            for (word, (t, s)) in target.iter_mut().zip(source).enumerate() {
                let keep = match (word * 64).cmp(&(p / 64 * 64)) {
                    std::cmp::Ordering::Less => u64::MAX,
                    std::cmp::Ordering::Equal => (1 << (p % 64)) - 1,
                    std::cmp::Ordering::Greater => 0,
                };
                *t |= *s & keep;
            }
        }
    }

    fn list(&mut self) {
        self.row_starts.clear();
        self.tiles.clear();
        self.tile_starts.clear();
        self.below.clear();
        self.below_starts.clear();
        let mut start = 0;
        for i in 0..self.nv {
            self.row_starts.push(start);
            start += (i + 1).next_multiple_of(TILE);
            self.tile_starts.push(self.tiles.len());
            for first in (0..=i).step_by(TILE) {
                if (first..=i.min(first + TILE - 1)).any(|c| self.has(i, c)) {
                    self.tiles.push(first as u32);
                }
            }
            self.below_starts.push(self.below.len());
            for k in i + 1..self.nv {
                if self.has(k, i) {
                    self.below.push(k as u32);
                }
            }
        }
        self.row_starts.push(start);
        self.tile_starts.push(self.tiles.len());
        self.below_starts.push(self.below.len());
    }

    pub fn nv(&self) -> usize {
        self.nv
    }
    /// Number of stored values, padding included.
    pub fn len(&self) -> usize {
        self.row_starts.last().copied().unwrap_or(0)
    }
    #[inline(always)]
    pub fn row_start(&self, i: usize) -> usize {
        self.row_starts[i]
    }
    /// First columns of the tiles of row `i`.
    #[inline(always)]
    pub fn tiles(&self, i: usize) -> &[u32] {
        &self.tiles[self.tile_starts[i]..self.tile_starts[i + 1]]
    }
    /// Rows below `i` with an entry in column `i`.
    #[inline(always)]
    pub fn below(&self, i: usize) -> &[u32] {
        &self.below[self.below_starts[i]..self.below_starts[i + 1]]
    }
}

/// Whether all of `dofs` (ascending) lie between the last of them and its root.
fn within_branch(tree: &Tree, dofs: &[u32]) -> bool {
    let Some(&last) = dofs.last() else {
        return true;
    };
    let row = tree.row(last as usize);
    row.starts_with(dofs) || dofs.iter().all(|dof| row.binary_search(dof).is_ok())
}
