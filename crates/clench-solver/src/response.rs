//! The response of the minimiser to changes of the gradient, by the implicit function theorem.
//!
//! If the gradient at the constant minimiser a* changes by dg, the minimiser changes by da = −H⁻¹ dg, with the Hessian
//! H = ∂g/∂a at a*. One factorization serves all changes, which are columns of a matrix.

use crate::costs::{BlockCost, Cost, MAX_DIM, Rows, Totals, with_cost};
use crate::descent::Direction;
use crate::iterate::Iterate;
use crate::newton::Newton;
use crate::options::Settings;
use crate::problem::Problem;
use crate::stopwatch::SolveClock;
use crate::threads::Threads;
use clench_math::{Mask, Real};

/// The factored Hessian of a problem at its minimiser.
#[derive(Clone, Debug, Default)]
pub struct Response<T: Real> {
    newton: Newton<T>,
    iterate: Iterate<T>,
    threads: Threads,
    clock: SolveClock,
    scratch: Vec<T>,
}

impl<T: Real> Response<T> {
    /// Factors the Hessian of a problem without Coulomb blocks at its minimiser `qacc`. Returns false if that needs
    /// larger matrices than the settings allow.
    pub fn factor(&mut self, problem: &Problem<T>, settings: &Settings, qacc: &[T]) -> bool {
        let fits = self.newton.prepare(problem, settings);
        self.iterate.start_at(problem, qacc);
        if fits {
            let (iterate, all) = (&self.iterate, T::Mask::splat(true));
            (self.newton).factor(problem, iterate, all, &self.threads, &mut self.clock);
        }
        fits
    }

    /// Returns J a − aref at the minimiser.
    pub fn residual(&self) -> &[T] {
        &self.iterate.residual
    }

    /// Returns the force of each row at the minimiser.
    pub fn force(&self) -> &[T] {
        &self.iterate.force
    }

    /// Computes X ← H⁻¹ X, for X of nv rows of `width` numbers.
    pub fn solve_columns(&mut self, x: &mut [T], width: usize) {
        self.newton.solve_columns(x, width, &mut self.scratch);
    }
}

/// Computes the force of a block of some cost other than [`Cost::Coulomb`] at the residual `y`, from the parameters of
/// its rows as in [`BlockMut`](crate::BlockMut).
pub fn block_force<T: Real>(cost: Cost, [d, r, shape]: [&[T]; 3], y: &[T], force: &mut [T]) {
    let mut active_set = [T::ZERO; 2 * MAX_DIM];
    let rows = Rows {
        d,
        r,
        shape,
        softer: T::ZERO,
        lambda: T::ZERO,
    };
    with_cost!(cost, C => {
        let len = <C as BlockCost<T>>::active_len(y.len());
        C::evaluate(rows, y, force, &mut active_set[..len], &mut Totals::new());
    });
}
