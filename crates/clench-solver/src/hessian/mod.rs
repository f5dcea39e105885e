//! The Hessian H = M + Jᵀ W J of the problem, and its factorization H = LᵀDL.
//!
//! Rows are eliminated from the last to the first, as for M itself, so a constraint within one branch of the tree
//! creates no fill. A constraint between branches makes one a descendant of the other; the result is again a tree, the
//! elimination tree. H is stored in one of two forms. [`PathForm`] stores whole paths of that tree, as M stores those
//! of the model's tree: it is the model's tree if no constraint couples branches, and a chain for the dense choice.
//! [`FilledForm`] stores only the filled entries, for heaps of many bodies. Both sum in the same order, so **all
//! choices agree to the bit**.

mod filled;
mod path_pairs;
mod paths;
mod rank_one;

use crate::block_index::BlockIndex;
use crate::costs::{Form, RankOne, Weight};
use crate::jacobian::StoredRows;
use crate::problem::Problem;
use crate::stopwatch::SolveClock;
use crate::threads::Threads;
use crate::tree::Tree;
use clench_math::Real;
use filled::FilledForm;
pub(crate) use path_pairs::PathPairs;
use paths::PathForm;

/// H and its factor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hessian<T: 'static> {
    paths: PathForm<T>,
    filled: FilledForm<T>,
    is_filled: bool,
    /// The inputs of the pattern: the model's parents, the couplings between branches, the dense choice.
    parents: Vec<Option<u32>>,
    couplings: Vec<u32>,
    dense: bool,
    /// The couplings of the current problem.
    found: Vec<u32>,
}

/// Smaller problems store paths: the analysis of the fill takes longer than it saves.
const MIN_FILLED_DOFS: usize = 36;
/// Whole paths are stored unless they take more than this many times the arithmetic of the filled form, whose blocks
/// are small.
const WORTH_FILLED: f64 = 2.0;

impl<T: Real> Hessian<T> {
    /// Fits the pattern to a problem. Returns false if it would have more than `max_entries` entries.
    pub(crate) fn prepare(
        &mut self,
        problem: &Problem<T>,
        dense: bool,
        max_entries: usize,
    ) -> bool {
        let tree = problem.tree();
        self.found.clear();
        if !dense {
            find_couplings(tree, &problem.jacobian, &mut self.found);
        }
        let same =
            self.parents == tree.parents() && self.dense == dense && self.couplings == self.found;
        if !same {
            self.dense = dense;
            self.couplings.clear();
            self.couplings.extend_from_slice(&self.found);
            self.parents.clear();
            self.parents.extend_from_slice(tree.parents());
            if !self.choose(tree, max_entries) {
                // Invalidated, so that the next problem of this pattern is refused as well.
                self.parents.clear();
                return false;
            }
        }
        let nnz = if self.is_filled {
            self.filled.nnz()
        } else {
            self.paths.nnz()
        };
        nnz <= max_entries
    }

    /// Chooses the form of H, and fits the pattern. Returns false if it would have more than `max_entries` entries.
    fn choose(&mut self, tree: &Tree, max_entries: usize) -> bool {
        self.is_filled = !self.dense
            && tree.nv() >= MIN_FILLED_DOFS
            && !self.found.is_empty()
            && self.filled.analyse(tree, &self.found, max_entries)
            && self.filled.saves() > WORTH_FILLED;
        if self.is_filled {
            return true;
        }
        if self.dense {
            // A dense Hessian has a single coupling of all dofs.
            self.found.push(tree.nv() as u32);
            self.found.extend(0..tree.nv() as u32);
        }
        self.paths.rebuild(tree, &self.found, max_entries)
    }

    /// Factors H = M + Jᵀ W J in the lanes of `mask`, on the threads if that pays. `weigh` writes the Hessian block of
    /// a constraint.
    #[inline(always)]
    pub(crate) fn factor(
        &mut self,
        problem: &Problem<T>,
        mask: T::Mask,
        threads: &Threads,
        clock: &mut SolveClock,
        weigh: impl Fn(&BlockIndex, &mut Weight<T>) -> Form + Sync,
    ) {
        if self.is_filled {
            self.filled.factor(problem, mask, threads, clock, weigh);
        } else {
            self.paths.factor(problem, mask, clock, weigh);
        }
    }

    /// Applies a rank-one change of a block's Hessian. Returns false in lanes whose factor becomes unusable.
    pub(crate) fn update(
        &mut self,
        problem: &Problem<T>,
        b: &BlockIndex,
        change: RankOne<T>,
    ) -> T::Mask {
        if self.is_filled {
            self.filled.update(problem, b, change)
        } else {
            self.paths.update(problem, b, change)
        }
    }

    /// Computes `x ← H⁻¹ x`.
    #[inline(always)]
    pub(crate) fn solve(&mut self, x: &mut [T]) {
        self.solve_transposed(x);
        self.complete_solve(x);
    }

    /// Computes `x ← L⁻ᵀ x`, the first part of [`solve`](Self::solve).
    #[inline(always)]
    pub(crate) fn solve_transposed(&mut self, x: &mut [T]) {
        if self.is_filled {
            self.filled.solve_transposed(x);
        } else {
            self.paths.solve_transposed(x);
        }
    }

    /// Computes `x ← L⁻¹ D⁻¹ x`, the rest of [`solve`](Self::solve).
    #[inline(always)]
    pub(crate) fn complete_solve(&mut self, x: &mut [T]) {
        if self.is_filled {
            self.filled.complete_solve(x);
        } else {
            self.paths.complete_solve(x);
        }
    }

    /// Appends D⁻¹ L⁻ᵀ x and L⁻ᵀ y for vectors x and y with these `entries` at the dofs of a block.
    #[inline(always)]
    pub(crate) fn push_pair(&mut self, dofs: &[u32], entries: &[[T; 2]], pairs: &mut PathPairs<T>) {
        if self.is_filled {
            self.filled.push_pair(dofs, entries, pairs);
        } else {
            self.paths.push_pair(dofs, entries, pairs);
        }
    }

    /// Computes `X ← H⁻¹ X` for X of nv rows of `width` numbers.
    pub(crate) fn solve_columns(&mut self, x: &mut [T], width: usize, scratch: &mut Vec<T>) {
        if !self.is_filled {
            return self.paths.solve_columns(x, width);
        }
        for column in 0..width {
            scratch.clear();
            scratch.extend(x[column..].iter().step_by(width));
            self.filled.solve(scratch);
            for (x, &solution) in x[column..].iter_mut().step_by(width).zip(&*scratch) {
                *x = solution;
            }
        }
    }

    /// Computes H⁻¹ times the derivatives of `x`.
    pub(crate) fn solve_tangents<N: Real<Value = T>>(&mut self, x: &mut [N], scratch: &mut Vec<T>) {
        if self.is_filled {
            N::map_tangents(x, scratch, |x| self.filled.solve(x));
        } else {
            self.paths.solve_varying(x);
        }
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
