//! The sparsity of a joint-space mass matrix, and its factorization without fill.
//!
//! Entry (i, j) of M is nonzero only if one degree of freedom is an ancestor of the other. With every parent numbered
//! before its children, the factorization M = LᵀDL, computed from the last row to the first, creates no entry outside
//! this pattern (Featherstone, *Rigid Body Dynamics Algorithms*, §6.5).
//!
//! A row lists a path from a root. So the row of an ancestor is a prefix of the row of each of its descendants, and a
//! column has the same index in all of them. The kernels use this: they run over contiguous values, without indices.

mod columns;
mod differentiated;
mod factor;
mod lu;
mod matrix;
mod solve;
#[cfg(test)]
mod tests;

use crate::error::ProblemError;
pub use differentiated::solve_differentiated;
pub use factor::TreeFactor;
pub use lu::TreeLu;
pub use matrix::TreeMatrix;
use std::collections::HashMap;
use std::ops::Range;

/// The sparsity pattern of M: the forest of degrees of freedom (dofs).
///
/// Row `i` of the pattern lists the ancestors of dof `i` in ascending order and ends with `i` itself: the lower
/// triangle of M in compressed rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    parents: Vec<Option<u32>>,
    starts: Vec<usize>,
    columns: Vec<u32>,
    trees: Vec<u32>,
    ntree: usize,
    /// All dofs in supernodes, ascending.
    supernodes: Vec<TreeSupernode>,
    /// For each dof, the starts of the rows of its descendants, ascending.
    descendants: Vec<u32>,
    descendant_starts: Vec<usize>,
}

/// A few dofs, each the only child of the one before. Their rows share all columns but the last few, and all have the
/// same descendants after the last. So kernels process several rows at once: a column is looked up once, and dependent
/// sums run in parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TreeSupernode {
    /// The first dof; the others follow it.
    pub first: usize,
    /// The number of dofs: 1 to [`MAX_SUPERNODE`].
    pub len: usize,
}

/// The maximum number of dofs: as many rows as fit into registers together with their operands.
pub(crate) const MAX_SUPERNODE: usize = 4;

/// Evaluates an expression with the constant `$len` set to the length of a supernode.
macro_rules! with_len {
    ($value:expr, $len:ident => $body:expr) => {
        match $value {
            1 => {
                const $len: usize = 1;
                $body
            }
            2 => {
                const $len: usize = 2;
                $body
            }
            3 => {
                const $len: usize = 3;
                $body
            }
            _ => {
                const $len: usize = $crate::tree::MAX_SUPERNODE;
                $body
            }
        }
    };
}
pub(crate) use with_len;

impl Tree {
    /// Creates a forest from the parent of each dof.
    ///
    /// # Errors
    /// Returns an error if a parent does not precede its child.
    pub fn new(parents: &[Option<usize>]) -> Result<Tree, ProblemError> {
        let mut tree = Tree::default();
        tree.rebuild(parents.len(), |i| parents[i])?;
        Ok(tree)
    }

    /// Creates the full lower triangle: a chain of `n` dofs.
    pub fn dense(n: usize) -> Tree {
        let mut tree = Tree::default();
        let chain = tree.rebuild(n, |i| i.checked_sub(1));
        debug_assert!(chain.is_ok(), "a chain is a valid tree");
        tree
    }

    /// Rebuilds the pattern in place, reusing its memory.
    pub(crate) fn rebuild(
        &mut self,
        nv: usize,
        parent: impl Fn(usize) -> Option<usize>,
    ) -> Result<(), ProblemError> {
        self.parents.clear();
        self.starts.clear();
        self.columns.clear();
        self.trees.clear();
        self.ntree = 0;
        self.starts.push(0);
        for dof in 0..nv {
            match parent(dof) {
                Some(p) if p >= dof => {
                    return Err(ProblemError::ParentAfterChild { dof, parent: p });
                }
                Some(p) => {
                    self.columns
                        .extend_from_within(self.starts[p]..self.starts[p + 1]);
                    self.trees.push(self.trees[p]);
                    self.parents.push(Some(p as u32));
                }
                None => {
                    self.trees.push(self.ntree as u32);
                    self.ntree += 1;
                    self.parents.push(None);
                }
            }
            self.columns.push(dof as u32);
            self.starts.push(self.columns.len());
        }
        self.list_descendants();
        self.find_supernodes();
        Ok(())
    }

    fn find_supernodes(&mut self) {
        self.supernodes.clear();
        for dof in 0..self.nv() {
            let only_child = self.parent(dof).is_some_and(|parent| {
                let below = self.descendants(dof).len();
                parent + 1 == dof && self.descendants(parent).len() == below + 1
            });
            match self.supernodes.last_mut() {
                Some(last) if last.len < MAX_SUPERNODE && only_child => last.len += 1,
                _ => self.supernodes.push(TreeSupernode { first: dof, len: 1 }),
            }
        }
    }

    /// Returns the values of the rows of a supernode; row m has depth + m + 1.
    #[inline(always)]
    pub(crate) fn supernode_rows<'a, T, const LEN: usize>(
        &self,
        values: &'a [T],
        first: usize,
    ) -> [&'a [T]; LEN] {
        let mut rows = [&values[..0]; LEN];
        for (m, row) in rows.iter_mut().enumerate() {
            *row = &values[self.starts[first + m]..self.starts[first + m + 1]];
        }
        rows
    }

    /// Limits the rows that factorizations and solutions over this tree, a copy of `whole`, compute to those of some
    /// dofs, which are whole trees. The others keep their values.
    pub fn limit_rows(&mut self, whole: &Tree, dofs: impl Iterator<Item = Range<usize>>) {
        self.supernodes.clear();
        let count = |dof: usize| whole.supernodes.partition_point(|s| s.first < dof);
        for dofs in dofs {
            let some = &whole.supernodes[count(dofs.start)..count(dofs.end)];
            self.supernodes.extend_from_slice(some);
        }
    }

    /// Returns, for each tree, the first one of the same shape: its dofs have the same parents, relative to the tree's
    /// first dof.
    pub(crate) fn first_of_same_shape(&self) -> Vec<u32> {
        let mut shapes: Vec<Vec<Option<u32>>> = vec![Vec::new(); self.ntree];
        let mut local = vec![0; self.nv()];
        for (dof, parent) in self.parents.iter().enumerate() {
            let shape = &mut shapes[self.trees[dof] as usize];
            local[dof] = shape.len() as u32;
            shape.push(parent.map(|parent| local[parent as usize]));
        }
        let mut first = HashMap::new();
        let shapes = shapes.into_iter().zip(0..);
        shapes
            .map(|(shape, tree)| *first.entry(shape).or_insert(tree))
            .collect()
    }

    fn list_descendants(&mut self) {
        let nv = self.nv();
        self.descendant_starts.clear();
        self.descendant_starts.resize(nv + 1, 0);
        for i in 0..nv {
            for c in self.starts[i]..self.starts[i + 1] - 1 {
                self.descendant_starts[self.columns[c] as usize + 1] += 1;
            }
        }
        for i in 0..nv {
            self.descendant_starts[i + 1] += self.descendant_starts[i];
        }
        self.descendants.clear();
        self.descendants.resize(self.descendant_starts[nv], 0);
        // Filling each list from its end restores its start.
        for i in (0..nv).rev() {
            for c in self.starts[i]..self.starts[i + 1] - 1 {
                let end = &mut self.descendant_starts[self.columns[c] as usize + 1];
                *end -= 1;
                self.descendants[*end] = self.starts[i] as u32;
            }
        }
        self.descendant_starts.rotate_left(1);
        if let Some(last) = self.descendant_starts.last_mut() {
            *last = self.descendants.len();
        }
    }

    /// Rebuilds the pattern from the same dofs with `couplings` (each a count, then ascending dofs): the elimination
    /// tree, whose paths contain all entries filled by eliminating the coupled matrix from its last row.
    ///
    /// Liu's algorithm, from the last dof to the first: the current tree of a neighbour becomes a child of the dof. Of
    /// a coupling, only the pairs of neighbouring dofs are needed, since the dofs above are already connected.
    ///
    /// Returns false and changes nothing if the pattern would have more than `max_entries` entries.
    pub(crate) fn rebuild_coupled(
        &mut self,
        tree: &Tree,
        couplings: &[u32],
        max_entries: usize,
        scratch: &mut CouplingScratch,
    ) -> bool {
        let nv = tree.nv();
        let CouplingScratch {
            edges,
            parents,
            roots,
        } = scratch;
        edges.clear();
        edges.extend((0..nv).filter_map(|i| tree.parents[i].map(|p| (p, i as u32))));
        let mut rest = couplings;
        while let Some((&count, tail)) = rest.split_first() {
            let (dofs, tail) = tail.split_at(count as usize);
            edges.extend(dofs.windows(2).map(|w| (w[0], w[1])));
            rest = tail;
        }
        edges.sort_unstable_by(|a, b| b.cmp(a));
        parents.clear();
        parents.resize(nv, None);
        roots.clear();
        roots.extend(0..nv as u32);
        for &(low, high) in &*edges {
            // The root of the tree that contains `high`, with path compression.
            let mut root = high as usize;
            while roots[root] as usize != root {
                roots[root] = roots[roots[root] as usize];
                root = roots[root] as usize;
            }
            if root != low as usize {
                roots[root] = low;
                parents[root] = Some(low as usize);
            }
        }
        // From here on `roots` holds row lengths.
        let mut entries = 0;
        for i in 0..nv {
            roots[i] = 1 + parents[i].map_or(0, |parent| roots[parent]);
            entries += roots[i] as usize;
        }
        if entries > max_entries {
            return false;
        }
        let ascending = self.rebuild(nv, |i| parents[i]);
        debug_assert!(ascending.is_ok(), "a dof hangs on one of lower number");
        true
    }

    /// Returns the starts of the rows of the descendants of dof `i`.
    #[inline(always)]
    pub(crate) fn descendants(&self, i: usize) -> &[u32] {
        &self.descendants[self.descendant_starts[i]..self.descendant_starts[i + 1]]
    }
    /// Returns the number of ancestors of dof `i`, which is its index in every row that contains it.
    #[inline(always)]
    pub(crate) fn depth(&self, i: usize) -> usize {
        self.starts[i + 1] - self.starts[i] - 1
    }

    /// Returns the number of dofs.
    #[inline(always)]
    pub fn nv(&self) -> usize {
        self.parents.len()
    }
    /// Returns the parent of each dof.
    #[inline(always)]
    pub(crate) fn parents(&self) -> &[Option<u32>] {
        &self.parents
    }
    /// Returns the parent of a dof, `None` for a root.
    pub fn parent(&self, dof: usize) -> Option<usize> {
        self.parents[dof].map(|p| p as usize)
    }
    /// Returns the ancestors of dof `i`, ascending, then `i` itself.
    #[inline(always)]
    pub fn row(&self, i: usize) -> &[u32] {
        &self.columns[self.starts[i]..self.starts[i + 1]]
    }
    /// Returns the start of row `i` in the stored values; `row_start(nv)` is their number.
    #[inline(always)]
    pub fn row_start(&self, i: usize) -> usize {
        self.starts[i]
    }
    /// Returns the number of stored values.
    #[inline(always)]
    pub fn nnz(&self) -> usize {
        self.columns.len()
    }
    /// Returns the index of the tree that contains a dof, in the order of their roots.
    pub fn tree_of(&self, dof: usize) -> usize {
        self.trees[dof] as usize
    }
    /// Returns the number of trees in the forest.
    pub fn ntree(&self) -> usize {
        self.ntree
    }
    /// Returns true if all of `dofs` (ascending) lie on the path from a root to the last of them.
    pub(crate) fn is_path(&self, dofs: &[u32]) -> bool {
        let Some(&last) = dofs.last() else {
            return true;
        };
        let row = self.row(last as usize);
        row.len() == dofs.len() && row == dofs
            || dofs.iter().all(|dof| row.binary_search(dof).is_ok())
    }
}

/// Scratch memory of [`Tree::rebuild_coupled`].
#[derive(Clone, Debug, Default)]
pub(crate) struct CouplingScratch {
    /// (lower, higher) dof.
    edges: Vec<(u32, u32)>,
    parents: Vec<Option<usize>>,
    /// The union-find structure.
    roots: Vec<u32>,
}
