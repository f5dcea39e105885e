//! The Hessian stored as whole paths of its elimination tree.

use super::path_pairs::PathPairs;
use super::rank_one::each_of_change;
use crate::block_index::BlockIndex;
use crate::costs::{Form, RankOne, Weight};
use crate::jacobian::Jacobian;
use crate::problem::Problem;
use crate::stopwatch::{SolveClock, SolvePart};
use crate::tree::{CouplingScratch, Tree, TreeFactor, TreeMatrix};
use clench_math::{Mask, Real, kernel};

/// H and its factor over a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct PathForm<T> {
    tree: Tree,
    matrix: TreeMatrix<T>,
    factor: TreeFactor<T>,
    /// The target when only some lanes are factored and the others keep their factor.
    spare: TreeFactor<T>,
    /// The vector of a rank-one update, along its path.
    direction: Vec<T>,
    scratch: CouplingScratch,
}

impl<T: Real> PathForm<T> {
    /// Fits the tree to that of M with couplings. Returns false if it would have more than `max_entries` entries.
    pub(super) fn rebuild(&mut self, tree: &Tree, couplings: &[u32], max_entries: usize) -> bool {
        if !(self.tree).rebuild_coupled(tree, couplings, max_entries, &mut self.scratch) {
            return false;
        }
        self.matrix.values.clear();
        self.matrix.values.resize(self.tree.nnz(), T::ZERO);
        self.factor.resize(&self.tree);
        true
    }

    /// Returns the number of entries.
    pub(super) fn nnz(&self) -> usize {
        self.tree.nnz()
    }

    /// See [`Hessian::factor`](super::Hessian::factor).
    #[inline(always)]
    pub(super) fn factor(
        &mut self,
        problem: &Problem<T>,
        mask: T::Mask,
        clock: &mut SolveClock,
        weigh: impl FnMut(&BlockIndex, &mut Weight<T>) -> Form,
    ) {
        self.set(problem.tree(), &problem.mass);
        let (tree, values) = (&self.tree, &mut self.matrix.values);
        T::vectorize(
            #[inline(always)]
            || problem.jacobian.add_gram(weigh, tree, values),
        );
        clock.lap(SolvePart::Hessian as usize);
        if mask.all() {
            self.factor.factor_safely(&self.tree, &self.matrix);
        } else {
            self.spare.factor_safely(&self.tree, &self.matrix);
            self.factor.take(mask, &self.spare);
        }
        clock.lap(SolvePart::Factorization as usize);
    }

    /// See [`Hessian::update`](super::Hessian::update).
    #[kernel]
    pub fn update(&mut self, problem: &Problem<T>, b: &BlockIndex, change: RankOne<T>) -> T::Mask {
        let Some(&last) = problem.jacobian.dofs(b).last() else {
            return T::Mask::splat(true);
        };
        let last = last as usize;
        self.direction.clear();
        self.direction.resize(self.tree.depth(last) + 1, T::ZERO);
        let (tree, direction) = (&self.tree, &mut self.direction);
        each_of_change(
            problem,
            b,
            &change,
            #[inline(always)]
            |dof, x| direction[tree.depth(dof)] = x,
        );
        self.factor.update(tree, last, direction, change.sigma)
    }

    /// Sets H = M.
    #[kernel]
    fn set(&mut self, tree: &Tree, mass: &TreeMatrix<T>) {
        if self.tree.nnz() == tree.nnz() {
            self.matrix.values.copy_from_slice(&mass.values);
            return;
        }
        self.matrix.values.fill(T::ZERO);
        for i in 0..tree.nv() {
            let row = self.matrix.row_mut(&self.tree, i);
            for (&c, &m) in tree.row(i).iter().zip(mass.row(tree, i)) {
                row[self.tree.depth(c as usize)] = m;
            }
        }
    }

    /// See [`Hessian::solve_transposed`](super::Hessian::solve_transposed).
    #[inline(always)]
    pub(super) fn solve_transposed(&self, x: &mut [T]) {
        self.factor.solve_transposed(&self.tree, x);
    }

    /// See [`Hessian::complete_solve`](super::Hessian::complete_solve).
    #[inline(always)]
    pub(super) fn complete_solve(&self, x: &mut [T]) {
        self.factor.complete_solve(&self.tree, x);
    }

    /// See [`Hessian::push_pair`](super::Hessian::push_pair).
    #[inline(always)]
    pub(super) fn push_pair(&self, dofs: &[u32], entries: &[[T; 2]], pairs: &mut PathPairs<T>) {
        let Some(&last) = dofs.last() else {
            return pairs.end();
        };
        let x = pairs.push_zeros(self.tree.row(last as usize));
        for (&dof, &entry) in dofs.iter().zip(entries) {
            x[self.tree.depth(dof as usize)] = entry;
        }
        self.factor.solve_pairs_along(&self.tree, last as usize, x);
    }

    /// See [`Hessian::solve_columns`](super::Hessian::solve_columns).
    pub(super) fn solve_columns(&self, x: &mut [T], width: usize) {
        self.factor.solve_columns(&self.tree, x, width);
    }

    /// Does the same in numbers with derivatives.
    pub(super) fn solve_varying<N: Real<Value = T>>(&self, x: &mut [N]) {
        self.factor.solve_varying(&self.tree, x);
    }
}
