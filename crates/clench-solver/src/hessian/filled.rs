//! The Hessian in what elimination fills.

use super::rank_one::each_of_change;
use crate::costs::{Form, RankOne, Weight};
use crate::jacobian::{BlockIndex, Jacobian};
use crate::sparse::{SparseFactor, SparsePattern};
use crate::{Problem, SolveClock, SolvePart, Tree};
use clench_math::{Mask, Real, kernel};

/// H and its factor over a sparse pattern.
#[derive(Clone, Debug, Default)]
pub(super) struct FilledForm<T> {
    pattern: SparsePattern,
    factor: SparseFactor<T>,
    /// Where some lanes are factored while others keep what they have.
    spare: SparseFactor<T>,
    /// The vector of a rank-one update; zeros between updates.
    direction: Vec<T>,
}

impl<T: Real> FilledForm<T> {
    /// Fits the pattern to that of M with couplings. False where it would have more than `most` entries.
    pub(super) fn analyse(&mut self, tree: &Tree, couplings: &[u32], most: usize) -> bool {
        if !self.pattern.analyse(tree, couplings, most) {
            return false;
        }
        self.factor.clear(&self.pattern);
        self.direction.clear();
        self.direction.resize(tree.nv(), T::ZERO);
        true
    }

    /// How much more arithmetic whole paths would take.
    pub(super) fn saves(&mut self) -> f64 {
        self.pattern.cost_of_paths() / self.pattern.cost()
    }

    /// Number of entries.
    pub(super) fn nnz(&self) -> usize {
        self.pattern.nnz()
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
        let pattern = &self.pattern;
        let factor = if mask.all() {
            &mut self.factor
        } else {
            &mut self.spare
        };
        factor.clear(pattern);
        factor.add_matrix(pattern, problem.tree(), &problem.mass);
        (problem.jacobian).add_gram(weigh, pattern, factor.values_mut());
        clock.lap(SolvePart::Hessian as usize);
        factor.factor_safely(pattern);
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

    /// `x ← H⁻¹ x`.
    #[inline(always)]
    pub(super) fn solve(&mut self, x: &mut [T]) {
        self.factor.solve(&self.pattern, x);
    }
}
