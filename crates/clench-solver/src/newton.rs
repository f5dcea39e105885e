//! Newton's direction: −H⁻¹ g with the Hessian of the pieces that the iterate is on.

use crate::costs::{BlockCost, with_cost};
use crate::descent::{Direction, Progress};
use crate::hessian::Hessian;
use crate::iterate::Iterate;
use crate::{Problem, Settings, SolveStats, Switch};
use clench_math::{Mask, Real};

/// Holds the factored Hessian.
#[derive(Clone, Debug, Default)]
pub(crate) struct Newton<T: Real> {
    hessian: Hessian<T>,
}

impl<T: Real> Direction<T> for Newton<T> {
    const NEWTON: bool = true;
    const PATIENCE: f64 = 2.0;

    fn prepare(&mut self, problem: &Problem<T>, settings: &Settings) {
        let dense = match settings.sparse_solve {
            Switch::On => false,
            Switch::Off => true,
            Switch::Auto => problem.tree().nnz() * 2 > problem.nv() * (problem.nv() + 1),
        };
        self.hessian.prepare(problem, dense);
    }

    fn restart(&mut self, _: T::Mask) {}

    fn find(
        &mut self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        progress: &Progress<T>,
        direction: &mut Vec<T>,
        stats: &mut SolveStats<T>,
    ) {
        // Where no piece changed on a stretch without curvature, the factor at hand is still exact.
        let stale = progress.live & !progress.same_hessian;
        if stale.any() {
            self.hessian.factor(problem, |b, weight| {
                let y = &iterate.residual[b.rows()];
                with_cost!(b.cost, C => {
                    let pieces = &iterate.pieces[b.pieces()];
                    C::hessian(problem.rows(b), y, pieces, weight)
                })
            });
            stats.factorizations += T::select(stale, T::ONE, T::ZERO);
        }
        direction.clear();
        direction.extend(iterate.gradient.iter().map(|&g| -g));
        self.hessian.solve(direction);
    }
}
