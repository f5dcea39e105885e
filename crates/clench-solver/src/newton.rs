//! Newton's direction −H⁻¹ g, with the Hessian of the pieces that the iterate is on.
//!
//! The factor is reused from one iteration to the next. If no piece changed it is still valid; if few did, it is
//! updated by a rank-one change for each; otherwise it is rebuilt. Each lane decides by its own changes only.

use crate::costs::{BlockCost, with_cost};
use crate::descent::{Convergence, Direction, SolverState};
use crate::hessian::Hessian;
use crate::iterate::Iterate;
use crate::options::{Settings, Switch};
use crate::prediction::Prediction;
use crate::problem::Problem;
use crate::stats::SolveStats;
use crate::stopwatch::{SolveClock, SolvePart};
use crate::threads::Threads;
use clench_math::{Mask, Real, Scalar, kernel};

/// Newton's method, with the factored Hessian.
#[derive(Clone, Debug)]
pub(crate) struct Newton<T: Real> {
    hessian: Hessian<T>,
    prediction: Prediction<T>,
    /// The active set of the factored Hessian, and the lanes in which it can be updated: factored and not curved.
    active_set: Vec<T>,
    updatable: T::Mask,
}

/// The maximum number of rank-one changes for which an update pays. Measured on a humanoid of 23 dofs: a solve with 4
/// to 10 contacts, cold or warm, takes 17 to 24% less time with updates than with a factorization in every iteration.
const MAX_UPDATES: f64 = 4.0;

impl<T: Real> Default for Newton<T> {
    fn default() -> Self {
        Newton {
            hessian: Hessian::default(),
            prediction: Prediction::default(),
            active_set: Vec::new(),
            updatable: T::Mask::splat(false),
        }
    }
}

impl<T: Real> Direction<T> for Newton<T> {
    const NEWTON: bool = true;
    const PATIENCE: f64 = 2.0;

    fn prepare(&mut self, problem: &Problem<T>, settings: &Settings) -> bool {
        // On trees sparse was faster, by 4% (half-cheetah, 9 dofs) to 18% (humanoid, 23 dofs); a single chain gains
        // nothing.
        let chain = problem.nv() * (problem.nv() + 1) / 2;
        let dense = match settings.sparse_solve {
            Switch::On => false,
            Switch::Off => true,
            Switch::Auto => problem.tree().nnz() == chain,
        };
        self.active_set.resize(problem.nactive, T::ZERO);
        self.updatable = T::Mask::splat(false);
        self.hessian.prepare(problem, dense, settings.max_matrix)
    }

    #[inline(always)]
    fn restart(&mut self, mask: T::Mask) {
        self.updatable &= !mask;
    }

    /// Returns infinity: Newton stops by gradient and improvement, because a small gap does not imply accurate forces
    /// of stiff constraints.
    #[inline(always)]
    fn gap(&mut self, _: &Problem<T>, _: &Iterate<T>) -> T {
        T::splat(T::Scalar::INFINITY)
    }

    #[kernel]
    fn find(
        &mut self,
        problem: &Problem<T>,
        convergence: &Convergence<T>,
        state: &mut SolverState<T>,
    ) {
        let SolverState {
            iterate,
            ray,
            stats,
            clock,
            threads,
        } = state;
        let mut stale = convergence.live & !convergence.same_hessian;
        if iterate.normal_forces.exist() {
            // Predictions change pieces as well.
            stale = convergence.live;
        }
        let updated = self.update(
            problem,
            iterate,
            stale & self.updatable & !convergence.curved,
            stats,
        );
        let rebuild = stale & !updated;
        if rebuild.any() {
            self.factor(problem, iterate, rebuild, threads, clock);
            stats.factorizations += T::select(rebuild, T::ONE, T::ZERO);
        }
        if stale.any() {
            self.active_set.copy_from_slice(&iterate.active_set);
            self.updatable = !convergence.curved;
        }
        clock.lap(SolvePart::Factorization as usize);
        let mut predicted = T::Mask::splat(false);
        if iterate.normal_forces.exist() {
            let lanes = convergence.live & iterate.normal_forces.predicts();
            predicted = (self.prediction).run(problem, &mut self.hessian, iterate, lanes);
        }
        ray.direction.clear();
        ray.direction.extend_from_slice(&iterate.gradient);
        for x in &mut ray.direction {
            *x = -*x;
        }
        if (convergence.live & !predicted).any() {
            self.hessian.solve(&mut ray.direction);
        }
        if predicted.any() {
            for (x, &step) in ray.direction.iter_mut().zip(self.prediction.step()) {
                *x = T::select(predicted, -step, *x);
            }
        }
    }
}

impl<T: Real> Newton<T> {
    /// Factors the Hessian at the iterate in the lanes of `mask`.
    #[inline(always)]
    pub(crate) fn factor(
        &mut self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        mask: T::Mask,
        threads: &Threads,
        clock: &mut SolveClock,
    ) {
        self.hessian.factor(
            problem,
            mask,
            threads,
            clock,
            #[inline(always)]
            |b, weight| {
                let y = &iterate.residual[b.rows()];
                let active_set = &iterate.active_set[b.active_range()];
                with_cost!(b.cost, C => C::hessian(iterate.rows(problem, b), y, active_set, weight))
            },
        );
    }

    /// Computes `x ← H⁻¹ x` with the factor.
    pub(crate) fn solve(&mut self, x: &mut [T]) {
        self.hessian.solve(x);
    }

    /// Computes `X ← H⁻¹ X` with the factor, for X of nv rows of `width` numbers.
    pub(crate) fn solve_columns(&mut self, x: &mut [T], width: usize, scratch: &mut Vec<T>) {
        self.hessian.solve_columns(x, width, scratch);
    }

    /// Computes H⁻¹ times the derivatives of `x`.
    pub(crate) fn solve_tangents<N: Real<Value = T>>(&mut self, x: &mut [N], scratch: &mut Vec<T>) {
        self.hessian.solve_tangents(x, scratch);
    }

    /// Updates the factor in the lanes of `mask` in which few pieces changed; returns the lanes in which that
    /// succeeded.
    #[kernel]
    fn update(
        &mut self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        mask: T::Mask,
        stats: &mut SolveStats<T>,
    ) -> T::Mask {
        if !mask.any() {
            return mask;
        }
        let mut count = T::ZERO;
        for b in &problem.jacobian.blocks {
            let (old, new) = (
                &self.active_set[b.active_range()],
                &iterate.active_set[b.active_range()],
            );
            with_cost!(b.cost, C => C::changes(iterate.rows(problem, b), old, new, |change| {
                count += T::select(change.sigma.eq(T::ZERO), T::ZERO, T::ONE);
            }));
        }
        let mut mask = mask & count.le(T::new(MAX_UPDATES));
        if !mask.any() {
            return mask;
        }
        for b in &problem.jacobian.blocks {
            let (old, new) = (
                &self.active_set[b.active_range()],
                &iterate.active_set[b.active_range()],
            );
            with_cost!(b.cost, C => C::changes(iterate.rows(problem, b), old, new, |mut change| {
                change.sigma = T::select(mask, change.sigma, T::ZERO);
                let touched = !change.sigma.eq(T::ZERO);
                if touched.any() {
                    mask &= self.hessian.update(problem, b, change) | !touched;
                    stats.updates += T::select(touched, T::ONE, T::ZERO);
                }
            }));
        }
        mask
    }
}
