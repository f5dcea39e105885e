//! The sparsity of a joint-space mass matrix, and its factorization without fill.
//!
//! Entry (i, j) of M is nonzero only where one degree of freedom is an ancestor of the other. Numbered from the root
//! outwards (every parent before its children), the factorization M = LᵀDL, computed from the last row to the first,
//! creates no entry outside this pattern (Featherstone, *Rigid Body Dynamics Algorithms*, §6.5).

use crate::ProblemError;
use clench_math::{Mask, Real};

/// Which degrees of freedom (dofs) hang on which: the sparsity pattern of M.
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
}

impl Tree {
    /// A forest from the parent of each dof.
    ///
    /// # Errors
    /// A parent that does not come before its child.
    pub fn new(parents: &[Option<usize>]) -> Result<Tree, ProblemError> {
        let mut tree = Tree::default();
        tree.rebuild(parents.len(), |i| parents[i])?;
        Ok(tree)
    }

    /// The full lower triangle: a chain of `n` dofs.
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
        Ok(())
    }

    /// Number of dofs.
    pub fn nv(&self) -> usize {
        self.parents.len()
    }
    /// The parent of a dof, `None` for a root.
    pub fn parent(&self, dof: usize) -> Option<usize> {
        self.parents[dof].map(|p| p as usize)
    }
    /// Ancestors of dof `i`, ascending, then `i` itself.
    pub fn row(&self, i: usize) -> &[u32] {
        &self.columns[self.starts[i]..self.starts[i + 1]]
    }
    /// Where row `i` starts among the stored values; `row_start(nv)` is their number.
    pub fn row_start(&self, i: usize) -> usize {
        self.starts[i]
    }
    /// Number of stored values.
    pub fn nnz(&self) -> usize {
        self.columns.len()
    }
    /// Which tree of the forest a dof belongs to, counted by their roots.
    pub fn tree_of(&self, dof: usize) -> usize {
        self.trees[dof] as usize
    }
    /// Number of trees in the forest.
    pub fn ntree(&self) -> usize {
        self.ntree
    }
    /// Whether `ancestor` is `dof` itself or one of its ancestors.
    pub fn is_ancestor(&self, ancestor: u32, dof: usize) -> bool {
        self.row(dof).binary_search(&ancestor).is_ok()
    }
}

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
    pub fn row<'a>(&'a self, tree: &Tree, i: usize) -> &'a [T] {
        &self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// The stored values of row `i`, to be written.
    pub fn row_mut<'a>(&'a mut self, tree: &Tree, i: usize) -> &'a mut [T] {
        &mut self.values[tree.starts[i]..tree.starts[i + 1]]
    }
    /// `out = A x`.
    pub fn mul(&self, tree: &Tree, x: &[T], out: &mut [T]) {
        for i in 0..tree.nv() {
            let (columns, values) = (tree.row(i), self.row(tree, i));
            let last = columns.len() - 1;
            let xi = x[i];
            let mut sum = values[last] * xi;
            for (&c, &v) in columns[..last].iter().zip(values) {
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

/// The factorization A = LᵀDL of a [`TreeMatrix`], L unit lower triangular in the same pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeFactor<T> {
    /// L below the diagonal; on the diagonal, its one is not stored but D's entry.
    values: Vec<T>,
    /// 1 / D.
    inverse_diagonal: Vec<T>,
}

impl<T: Real> TreeFactor<T> {
    /// An empty factor, to be filled by [`factor`](Self::factor).
    pub fn zeros(tree: &Tree) -> Self {
        TreeFactor {
            values: vec![T::ZERO; tree.nnz()],
            inverse_diagonal: vec![T::ZERO; tree.nv()],
        }
    }

    /// Factors `matrix`. False in lanes that met a pivot that is not positive: their factor is not usable.
    pub fn factor(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) -> T::Mask {
        self.values.clear();
        self.values.extend_from_slice(&matrix.values);
        self.inverse_diagonal.resize(tree.nv(), T::ZERO);
        let mut positive = T::Mask::splat(true);
        for k in (0..tree.nv()).rev() {
            let (before, row) = self.values.split_at_mut(tree.starts[k]);
            let columns = tree.row(k);
            let last = columns.len() - 1;
            let pivot = row[last];
            positive &= pivot.gt(T::ZERO) & pivot.is_finite();
            let inverse = T::ONE / pivot;
            self.inverse_diagonal[k] = inverse;
            // The row of an ancestor is a prefix of this row's pattern.
            for (j, &i) in columns[..last].iter().enumerate() {
                let scaled = row[j] * inverse;
                let start = tree.starts[i as usize];
                for (target, &value) in before[start..=start + j].iter_mut().zip(&*row) {
                    *target -= scaled * value;
                }
            }
            for value in &mut row[..last] {
                *value *= inverse;
            }
        }
        positive
    }

    /// Becomes the part of `whole`, the factor over `tree`, that belongs to the complete trees of `dofs`.
    pub(crate) fn gather(&mut self, tree: &Tree, whole: &TreeFactor<T>, dofs: &[u32]) {
        self.values.clear();
        self.inverse_diagonal.clear();
        for &dof in dofs {
            let dof = dof as usize;
            self.values
                .extend_from_slice(&whole.values[tree.starts[dof]..tree.starts[dof + 1]]);
            self.inverse_diagonal.push(whole.inverse_diagonal[dof]);
        }
    }

    /// Becomes lane `lane` of `whole`.
    pub(crate) fn gather_lane<L: Real<Scalar = T>>(&mut self, whole: &TreeFactor<L>, lane: usize) {
        self.values.clear();
        self.values
            .extend(whole.values.iter().map(|x| x.lane(lane)));
        self.inverse_diagonal.clear();
        self.inverse_diagonal
            .extend(whole.inverse_diagonal.iter().map(|x| x.lane(lane)));
    }

    /// `x ← A⁻¹ x`.
    pub fn solve(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        for (x, &inverse) in x.iter_mut().zip(&self.inverse_diagonal) {
            *x *= inverse;
        }
        self.solve_lower(tree, x);
    }

    /// `x ← D^(-1/2) L^(-T) x`: afterwards `x·y` is the product `xᵀA⁻¹y` of what was given.
    pub fn solve_half(&self, tree: &Tree, x: &mut [T]) {
        self.solve_transposed(tree, x);
        for (x, &inverse) in x.iter_mut().zip(&self.inverse_diagonal) {
            *x *= inverse.sqrt();
        }
    }

    fn solve_transposed(&self, tree: &Tree, x: &mut [T]) {
        for k in (0..tree.nv()).rev() {
            let xk = x[k];
            let columns = tree.row(k);
            for (&c, &v) in columns[..columns.len() - 1]
                .iter()
                .zip(&self.values[tree.starts[k]..])
            {
                x[c as usize] -= v * xk;
            }
        }
    }

    fn solve_lower(&self, tree: &Tree, x: &mut [T]) {
        for k in 0..tree.nv() {
            let mut sum = x[k];
            let columns = tree.row(k);
            for (&c, &v) in columns[..columns.len() - 1]
                .iter()
                .zip(&self.values[tree.starts[k]..])
            {
                sum -= v * x[c as usize];
            }
            x[k] = sum;
        }
    }
}
