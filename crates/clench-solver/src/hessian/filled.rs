//! The Hessian stored as the entries that elimination fills.

use super::path_pairs::PathPairs;
use super::rank_one::each_of_change;
use crate::block_index::BlockIndex;
use crate::costs::{Form, RankOne, Weight};
use crate::jacobian::Jacobian;
use crate::problem::Problem;
use crate::sparse::{SparseFactor, SparsePattern, Window};
use crate::stopwatch::{SolveClock, SolvePart};
use crate::threads::Threads;
use crate::tree::Tree;
use clench_math::{Mask, Real, kernel};

/// H and its factor over a sparse pattern.
#[derive(Clone, Debug, Default)]
pub(super) struct FilledForm<T: 'static> {
    pattern: SparsePattern,
    factor: SparseFactor<T>,
    /// The target when only some lanes are factored and the others keep their factor.
    spare: SparseFactor<T>,
    /// The vector of a rank-one update; zero between updates.
    direction: Vec<T>,
    /// The pair of vectors of a partial solve; zero between solves.
    pair: Vec<[T; 2]>,
}

/// Calls `work` for `count` windows of about the same size, with their values. (More windows than threads do not pay:
/// each inspects all blocks.)
fn split<T: Real>(
    threads: &Threads,
    window: Window,
    values: &mut [T],
    count: usize,
    work: &(impl Fn(&Window, &mut [T]) + Sync),
) {
    if count <= 1 {
        return work(&window, values);
    }
    let first = count / 2;
    let (one, other) = window.split(first, count);
    let (values_of_one, values_of_other) = values.split_at_mut(one.len());
    threads.join(
        || split(threads, one, values_of_one, first, work),
        || split(threads, other, values_of_other, count - first, work),
    );
}

impl<T: Real> FilledForm<T> {
    /// Fits the pattern to that of M with couplings. Returns false if it would have more than `max_entries` entries.
    pub(super) fn analyse(&mut self, tree: &Tree, couplings: &[u32], max_entries: usize) -> bool {
        if !self.pattern.analyse(tree, couplings, max_entries) {
            return false;
        }
        self.factor.resize(&self.pattern);
        self.direction.clear();
        self.direction.resize(tree.nv(), T::ZERO);
        self.pair.clear();
        self.pair.resize(tree.nv(), [T::ZERO; 2]);
        true
    }

    /// Returns the ratio of the arithmetic with whole paths to that of this form.
    pub(super) fn saves(&mut self) -> f64 {
        self.pattern.cost_of_paths() / self.pattern.cost()
    }

    /// Returns the number of entries.
    pub(super) fn nnz(&self) -> usize {
        self.pattern.nnz()
    }

    /// See [`Hessian::factor`](super::Hessian::factor).
    #[inline(always)]
    pub(super) fn factor(
        &mut self,
        problem: &Problem<T>,
        mask: T::Mask,
        threads: &Threads,
        clock: &mut SolveClock,
        weigh: impl Fn(&BlockIndex, &mut Weight<T>) -> Form + Sync,
    ) {
        let pattern = &self.pattern;
        let factor = if mask.all() {
            &mut self.factor
        } else {
            self.spare.resize(pattern);
            &mut self.spare
        };
        let assemble = |window: &Window, values: &mut [T]| {
            window.set_matrix(problem.tree(), &problem.mass, values);
            // The columns of a body are consecutive: they fill registers even in a single environment.
            T::vectorize_rows(
                #[inline(always)]
                || problem.jacobian.add_gram(&weigh, window, values),
            );
        };
        let (rows, values) = (Window::whole(pattern), factor.values_mut());
        split(threads, rows, values, threads.count(), &assemble);
        clock.lap(SolvePart::Hessian as usize);
        factor.factor_safely(pattern, threads);
        if !mask.all() {
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
        let direction = &mut self.direction;
        each_of_change(
            problem,
            b,
            &change,
            #[inline(always)]
            |dof, x| direction[dof] = x,
        );
        (self.factor).update(&self.pattern, last as usize, direction, change.sigma)
    }

    /// Computes `x ← H⁻¹ x`.
    #[inline(always)]
    pub(super) fn solve(&mut self, x: &mut [T]) {
        self.factor.solve(&self.pattern, x);
    }

    /// See [`Hessian::solve_transposed`](super::Hessian::solve_transposed).
    #[inline(always)]
    pub(super) fn solve_transposed(&mut self, x: &mut [T]) {
        self.factor.solve_transposed(&self.pattern, x);
    }

    /// See [`Hessian::complete_solve`](super::Hessian::complete_solve).
    #[inline(always)]
    pub(super) fn complete_solve(&mut self, x: &mut [T]) {
        self.factor.complete_solve(&self.pattern, x);
    }

    /// See [`Hessian::push_pair`](super::Hessian::push_pair).
    #[inline(always)]
    pub(super) fn push_pair(&mut self, dofs: &[u32], entries: &[[T; 2]], pairs: &mut PathPairs<T>) {
        let Some(&last) = dofs.last() else {
            return pairs.end();
        };
        for (&dof, &entry) in dofs.iter().zip(entries) {
            self.pair[dof as usize] = entry;
        }
        self.factor.solve_pairs_along(
            &self.pattern,
            last as usize,
            &mut self.pair,
            #[inline(always)]
            |dof, entry| pairs.push_entry(dof, entry),
        );
        pairs.end_reversed();
    }
}
