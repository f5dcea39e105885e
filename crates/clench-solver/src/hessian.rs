//! The Hessian H = M + Jᵀ W J of the problem, and its factorization H = LᵀDL.
//!
//! Rows are eliminated from the last to the first, as for M itself: then a constraint within one branch of the tree
//! creates no fill. A constraint between branches makes one hang on the other, and what comes out is a tree again, the
//! elimination tree. So H and its factor live in the pattern of a [`Tree`] of their own, like M in that of the model: the
//! model's where no constraint couples branches, a chain for the dense choice. Both choices run the same kernels, and
//! **sparse and dense agree to the bit**.

use crate::costs::{Form, RankOne, Weight};
use crate::jacobian::{BlockIndex, Jacobian, StoredRows};
use crate::tree::Coupling;
use crate::{Problem, SolveClock, SolvePart, Tree, TreeFactor, TreeMatrix};
use clench_math::{Mask, Real, kernel};

/// H and its factor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hessian<T> {
    tree: Tree,
    matrix: TreeMatrix<T>,
    factor: TreeFactor<T>,
    /// Where some lanes are factored while others keep what they have.
    spare: TreeFactor<T>,
    /// The vector of a rank-one update, along its path.
    direction: Vec<T>,
    /// What the tree was made from: the model's parents, the couplings that are not within a branch, the choice.
    parents: Vec<Option<u32>>,
    couplings: Vec<u32>,
    dense: bool,
    /// The couplings of the problem at hand.
    found: Vec<u32>,
    scratch: Coupling,
}

impl<T: Real> Hessian<T> {
    /// Fits the pattern to a problem. False where it would have more than `most` entries.
    pub fn prepare(&mut self, problem: &Problem<T>, dense: bool, most: usize) -> bool {
        let tree = problem.tree();
        self.found.clear();
        if !dense {
            find_couplings(tree, &problem.jacobian, &mut self.found);
        }
        if self.parents == tree.parents() && self.dense == dense && self.couplings == self.found {
            return self.tree.nnz() <= most;
        }
        self.dense = dense;
        self.couplings.clear();
        self.couplings.extend_from_slice(&self.found);
        self.parents.clear();
        self.parents.extend_from_slice(tree.parents());
        if dense {
            // The one coupling of a dense Hessian is that of all dofs.
            self.found.push(tree.nv() as u32);
            self.found.extend(0..tree.nv() as u32);
        }
        if !(self.tree).rebuild_coupled(tree, &self.found, most, &mut self.scratch) {
            self.parents.clear();
            return false;
        }
        self.matrix.values.clear();
        self.matrix.values.resize(self.tree.nnz(), T::ZERO);
        self.factor.resize(&self.tree);
        true
    }

    /// Factors H = M + Jᵀ W J in the lanes of `mask`. `weigh` writes the Hessian block of a constraint.
    #[inline(always)]
    pub fn factor(
        &mut self,
        problem: &Problem<T>,
        mask: T::Mask,
        clock: &mut SolveClock,
        weigh: impl FnMut(&BlockIndex, &mut Weight<T>) -> Form,
    ) {
        self.set(problem.tree(), &problem.mass);
        problem
            .jacobian
            .add_gram(weigh, &self.tree, &mut self.matrix.values);
        clock.lap(SolvePart::Hessian as usize);
        if mask.all() {
            self.factor.factor_safely(&self.tree, &self.matrix);
        } else {
            self.spare.factor_safely(&self.tree, &self.matrix);
            self.factor.take(mask, &self.spare);
        }
        clock.lap(SolvePart::Factorization as usize);
    }

    /// Applies a rank-one change of a block's Hessian. False in lanes whose factor it spoils.
    #[kernel]
    pub fn update(&mut self, problem: &Problem<T>, b: &BlockIndex, change: RankOne<T>) -> T::Mask {
        let (dofs, values) = (problem.jacobian.dofs(b), problem.jacobian.values(b));
        let Some(&last) = dofs.last() else {
            return T::Mask::splat(true);
        };
        let last = last as usize;
        self.direction.clear();
        self.direction.resize(self.tree.depth(last) + 1, T::ZERO);
        let row = |i: usize| &values[i * b.ndof..(i + 1) * b.ndof];
        for (k, &dof) in dofs.iter().enumerate() {
            let side = change
                .side
                .map_or(T::ZERO, |(side, factor)| factor * row(side)[k]);
            self.direction[self.tree.depth(dof as usize)] = row(change.row)[k] + side;
        }
        self.factor
            .update(&self.tree, last, &mut self.direction, change.sigma)
    }

    /// H = M.
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

    /// `x ← H⁻¹ x`.
    #[inline(always)]
    pub fn solve(&self, x: &mut [T]) {
        self.factor.solve(&self.tree, x);
    }
}

/// Lists the dofs of each block that acts on more than one branch: a count, then the dofs.
fn find_couplings<T: Real>(tree: &Tree, rows: &StoredRows<T>, found: &mut Vec<u32>) {
    let mut last = &[][..];
    for b in &rows.blocks {
        let dofs = rows.dofs(b);
        if dofs != last && !tree.is_path(dofs) {
            found.push(dofs.len() as u32);
            found.extend_from_slice(dofs);
        }
        last = dofs;
    }
}
