//! The symbolic analysis: the entries that elimination fills.
//!
//! Rows are eliminated from the last to the first. Left of its diagonal, row i holds the entries of the matrix and
//! those of its children in the elimination tree: the rows eliminated before whose last entry is in column i. A row
//! with the same entries as the next row, except for that row's own column, joins its supernode. (George & Liu,
//! *Computer Solution of Large Sparse Positive Definite Systems*, 1981; Davis, *Direct Methods for Sparse Linear
//! Systems*, 2006, §4.)

use crate::minimum_degree::merge;
use crate::partition::Lists;
use crate::tree::Tree;
use std::ops::Range;

/// The filled pattern of a symmetric matrix, in supernodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct SparsePattern {
    /// The supernodes in the order of elimination: those of the last dofs come first.
    supernodes: Vec<Supernode>,
    /// The supernode of each dof.
    supernode_of: Vec<u32>,
    /// The columns to the left of each supernode's own, ascending, and the runs of consecutive columns.
    columns: Vec<u32>,
    runs: Vec<Run>,
    /// The updates of each supernode by earlier ones.
    updates: Vec<Update>,
    nnz: usize,
    scratch: Scratch,
}

/// Consecutive dofs whose rows share their columns. Row m of a supernode has its `columns` and those of its first m + 1
/// dofs. All its rows are stored with the same length, as one dense block.
#[derive(Clone, Debug)]
pub(crate) struct Supernode {
    pub first: usize,
    /// The number of dofs: 1 to [`MAX_DOFS`].
    pub len: usize,
    columns: Range<usize>,
    runs: Range<usize>,
    updates: Range<usize>,
    /// The start of its block in the values.
    pub start: usize,
}

impl Supernode {
    /// Returns the number of columns to the left of its own.
    #[inline(always)]
    pub(crate) fn shared(&self) -> usize {
        self.columns.len()
    }
    /// Returns the stored length of its rows.
    #[inline(always)]
    pub(crate) fn width(&self) -> usize {
        self.shared() + self.len
    }
    /// Returns the range of the row of one of its dofs in the values, without the diagonal.
    #[inline(always)]
    pub(crate) fn row(&self, dof: usize) -> Range<usize> {
        let m = dof - self.first;
        let start = self.start + m * self.width();
        start..start + self.shared() + m
    }
    /// Returns the range of its block in the values.
    #[inline(always)]
    pub(crate) fn block(&self) -> Range<usize> {
        self.start..self.start + self.len * self.width()
    }
}

/// Consecutive dofs in the columns of a supernode. They are adjacent in every row that has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub dof: u32,
    /// The index of the first in the columns.
    pub offset: u32,
    pub len: u32,
}

/// The update of a later supernode by an earlier one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Update {
    /// The earlier supernode.
    pub source: u32,
    /// The index in its columns of the first that is a row of the later one, and their number.
    pub offset: u32,
    pub count: u32,
}

/// The maximum number of dofs. Longer supernodes are split: larger blocks gain little.
pub(super) const MAX_DOFS: usize = 12;

/// Scratch memory of an analysis.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// For each dof: the couplings whose last dof it is, as offsets into their list; the supernodes whose last column
    /// it is.
    couplings: Lists,
    children: Lists,
    /// The row for which each column was found last.
    found: Vec<u32>,
    union: Vec<u32>,
    merged: Vec<u32>,
    has_child: Vec<bool>,
}

/// The two passes over a list: counting, then writing.
#[derive(Clone, Copy, PartialEq)]
enum Pass {
    Count,
    Write,
}

impl SparsePattern {
    /// Analyses the pattern of M over `tree` with `couplings` (each a count, then ascending dofs). Returns false if it
    /// would have more than `max_entries` entries.
    pub(crate) fn analyse(&mut self, tree: &Tree, couplings: &[u32], max_entries: usize) -> bool {
        let nv = tree.nv();
        self.supernodes.clear();
        self.supernode_of.clear();
        self.supernode_of.resize(nv, 0);
        self.columns.clear();
        self.runs.clear();
        self.nnz = 0;
        self.scratch.start(tree, couplings);
        for dof in (0..nv).rev() {
            self.find_columns(tree, couplings, dof);
            let is_child = self.open_child(dof).is_some();
            let columns = self.scratch.union.len();
            let fits = |open: &&mut Supernode| {
                is_child && open.len < MAX_DOFS && open.shared() == columns + 1
            };
            if let Some(open) = self.supernodes.last_mut().filter(fits) {
                self.columns.pop();
                open.columns.end -= 1;
                (open.first, open.len) = (dof, open.len + 1);
            } else {
                if !self.close(max_entries) {
                    return false;
                }
                let start = self.columns.len();
                self.columns.extend_from_slice(&self.scratch.union);
                self.supernodes.push(Supernode {
                    first: dof,
                    len: 1,
                    columns: start..self.columns.len(),
                    runs: 0..0,
                    updates: 0..0,
                    start: self.nnz,
                });
            }
            self.supernode_of[dof] = self.supernodes.len() as u32 - 1;
        }
        let fits = self.close(max_entries);
        if fits {
            self.list_updates();
        }
        fits
    }

    /// Lists the updates of each supernode, in the order of elimination.
    fn list_updates(&mut self) {
        let mut count = 0;
        for pass in [Pass::Count, Pass::Write] {
            for source in 0..self.supernodes.len() {
                let columns = self.supernodes[source].columns.clone();
                let mut next = columns.start;
                while next < columns.end {
                    let target = self.supernode_of[self.columns[next] as usize] as usize;
                    let target = &mut self.supernodes[target];
                    let end = target.first + target.len;
                    let rows = self.columns[next..columns.end].iter();
                    let rows = rows.take_while(|&&dof| (dof as usize) < end).count();
                    if pass == Pass::Write {
                        self.updates[target.updates.end] = Update {
                            source: source as u32,
                            offset: (next - columns.start) as u32,
                            count: rows as u32,
                        };
                    }
                    target.updates.end += 1;
                    next += rows;
                }
            }
            if pass == Pass::Count {
                for s in &mut self.supernodes {
                    let own = s.updates.len();
                    s.updates = count..count;
                    count += own;
                }
                self.updates.clear();
                self.updates.resize(count, Update::default());
            }
        }
    }

    /// Collects in `scratch.union` the columns of row `dof` left of the diagonal.
    fn find_columns(&mut self, tree: &Tree, couplings: &[u32], dof: usize) {
        let open = self.open_child(dof);
        let Scratch {
            found,
            union,
            merged,
            has_child,
            couplings: lists,
            children,
        } = &mut self.scratch;
        let row = dof as u32;
        union.clear();
        // The columns of the matrix. A row of M that has a child gets its columns from the child.
        if !has_child[dof] {
            union.extend(tree.row(dof).iter().filter(|&&column| column < row));
            (union.iter()).for_each(|&column| found[column as usize] = row);
        }
        let own = union.len();
        for at in lists.iter(row) {
            let (count, at) = (couplings[at as usize] as usize, at as usize + 1);
            for &column in &couplings[at..at + count - 1] {
                if found[column as usize] != row {
                    found[column as usize] = row;
                    union.push(column);
                }
            }
        }
        if union.len() > own {
            union.sort_unstable();
        }
        // The columns of the rows eliminated before, except this row's own.
        for child in children.iter(row).chain(open) {
            let columns = &self.columns[self.supernodes[child as usize].columns.clone()];
            let columns = &columns[..columns.len() - 1];
            if union.is_empty() {
                union.extend_from_slice(columns);
            } else {
                merge(union, columns, merged);
                std::mem::swap(union, merged);
            }
        }
    }

    /// Returns the open supernode if its last column is `dof`.
    fn open_child(&self, dof: usize) -> Option<u32> {
        let open = self.supernodes.last()?;
        let is_last = self.columns[open.columns.clone()].last() == Some(&(dof as u32));
        is_last.then_some(self.supernodes.len() as u32 - 1)
    }

    /// Completes the open supernode. Returns false if there are now more than `max_entries` entries.
    fn close(&mut self, max_entries: usize) -> bool {
        let Some(last) = self.supernodes.last_mut() else {
            return true;
        };
        let (columns, start) = (&self.columns[last.columns.clone()], self.runs.len());
        for (offset, &dof) in columns.iter().enumerate() {
            match self.runs[start..].last_mut() {
                Some(run) if run.dof + run.len == dof => run.len += 1,
                _ => self.runs.push(Run {
                    dof,
                    offset: offset as u32,
                    len: 1,
                }),
            }
        }
        last.runs = start..self.runs.len();
        self.nnz += last.len * last.width();
        if let Some(&parent) = columns.last() {
            let index = self.supernodes.len() as u32 - 1;
            self.scratch.children.push_front(parent, index);
        }
        self.nnz <= max_entries
    }

    /// Returns the number of stored values.
    pub(crate) fn nnz(&self) -> usize {
        self.nnz
    }
    /// Returns the number of dofs.
    pub(crate) fn nv(&self) -> usize {
        self.supernode_of.len()
    }
    /// Returns the supernodes in the order of elimination.
    #[inline(always)]
    pub(crate) fn supernodes(&self) -> &[Supernode] {
        &self.supernodes
    }
    /// Returns the supernode of a dof.
    #[inline(always)]
    pub(crate) fn supernode_of(&self, dof: usize) -> &Supernode {
        &self.supernodes[self.supernode_of[dof] as usize]
    }
    /// Returns the columns to the left of a supernode's own, ascending.
    #[inline(always)]
    pub(crate) fn columns(&self, supernode: &Supernode) -> &[u32] {
        &self.columns[supernode.columns.clone()]
    }
    /// Returns the columns to the left of the diagonal in the row of a dof, ascending; the last is its parent in the
    /// elimination tree.
    #[inline(always)]
    pub(crate) fn columns_of_row(
        &self,
        supernode: &Supernode,
        dof: usize,
    ) -> impl DoubleEndedIterator<Item = u32> + Clone + use<'_> {
        let own = supernode.first as u32..dof as u32;
        self.columns(supernode).iter().copied().chain(own)
    }
    /// Returns the same columns as runs.
    #[inline(always)]
    pub(crate) fn runs(&self, supernode: &Supernode) -> &[Run] {
        &self.runs[supernode.runs.clone()]
    }
    /// Returns the updates of a supernode by earlier ones, in the order of elimination.
    #[inline(always)]
    pub(crate) fn updates(&self, supernode: &Supernode) -> &[Update] {
        &self.updates[supernode.updates.clone()]
    }

    /// Returns the index of a column in the rows of its supernode.
    #[inline(always)]
    pub(super) fn row_of_column(&self, supernode: &Supernode, column: usize) -> usize {
        if column >= supernode.first {
            return supernode.shared() + column - supernode.first;
        }
        let runs = self.runs(supernode);
        let run = runs[runs.partition_point(|run| run.dof as usize <= column) - 1];
        run.offset as usize + column - run.dof as usize
    }

    /// Returns the approximate number of multiplications of a factorization.
    pub(crate) fn cost(&self) -> f64 {
        let of = |s: &Supernode| s.len as f64 * (s.width() as f64).powi(2) / 2.0;
        self.supernodes.iter().map(of).sum()
    }

    /// Returns the same number for storage of whole elimination-tree paths.
    pub(crate) fn cost_of_paths(&mut self) -> f64 {
        let depths = &mut self.scratch.found;
        let mut cost = 0.0;
        for s in self.supernodes.iter().rev() {
            let parent = self.columns[s.columns.clone()].last();
            let above = parent.map_or(0, |&parent| depths[parent as usize] + 1);
            for m in 0..s.len {
                depths[s.first + m] = above + m as u32;
                cost += f64::from(above + m as u32).powi(2) / 2.0;
            }
        }
        cost
    }
}

impl Scratch {
    fn start(&mut self, tree: &Tree, couplings: &[u32]) {
        let nv = tree.nv();
        self.found.clear();
        self.found.resize(nv, u32::MAX);
        self.has_child.clear();
        self.has_child.resize(nv, false);
        for parent in (0..nv).filter_map(|dof| tree.parent(dof)) {
            self.has_child[parent] = true;
        }
        self.children.clear(nv);
        self.couplings.clear(nv);
        let mut at = 0;
        while at < couplings.len() {
            let next = at + 1 + couplings[at] as usize;
            self.couplings.push_front(couplings[next - 1], at as u32);
            at = next;
        }
    }
}
