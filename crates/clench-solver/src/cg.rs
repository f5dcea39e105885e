//! Conjugate gradients, preconditioned by the mass matrix (Polak–Ribière).
//!
//! The direction restarts from −M⁻¹g if β would be negative, or if consecutive gradients are far from orthogonal
//! (Powell, *Restart procedures for the conjugate gradient method*, 1977):
//!
//! ```text
//! |gᵀM⁻¹g_prev| ≥ 0.2 gᵀM⁻¹g
//! ```
//!
//! On a quadratic they are orthogonal. If they are not, the cost has changed its piece, and the old direction is
//! conjugate with respect to an outdated Hessian.

use crate::descent::{Convergence, Direction, SolverState};
use crate::iterate::{Iterate, dot};
use crate::options::Settings;
use crate::problem::Problem;
use clench_math::{Real, kernel};

/// Powell's limit: consecutive gradients whose overlap is this fraction of the new one are far from orthogonal.
pub(crate) const OVERLAP: f64 = 0.2;

/// The last two gradients, and their images under M⁻¹.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cg<T> {
    /// The gradient from which the last direction was computed.
    gradient: Vec<T>,
    /// M⁻¹ times that gradient.
    last: Vec<T>,
    /// M⁻¹ times the current gradient, and true if it is up to date.
    preconditioned: Vec<T>,
    is_current: bool,
    /// True once this solve has computed a direction.
    started: bool,
}

impl<T: Real> Cg<T> {
    #[kernel]
    fn precondition(&mut self, problem: &Problem<T>, iterate: &Iterate<T>) {
        self.preconditioned.clear();
        self.preconditioned.extend_from_slice(&iterate.gradient);
        problem
            .mass_factor
            .solve(problem.tree(), &mut self.preconditioned);
        self.is_current = true;
    }
}

impl<T: Real> Direction<T> for Cg<T> {
    const NEWTON: bool = false;
    const PATIENCE: f64 = 20.0;

    #[inline(always)]
    fn prepare(&mut self, _: &Problem<T>, _: &Settings) -> bool {
        self.started = false;
        self.is_current = false;
        true
    }

    #[inline(always)]
    fn restart(&mut self, mask: T::Mask) {
        for g in &mut self.gradient {
            *g = T::select(mask, T::ZERO, *g);
        }
        self.is_current = false;
    }

    /// Computes the duality gap. The next direction needs M⁻¹g anyway, so the gap costs only an inner product.
    #[inline(always)]
    fn gap(&mut self, problem: &Problem<T>, iterate: &Iterate<T>) -> T {
        std::mem::swap(&mut self.last, &mut self.preconditioned);
        self.precondition(problem, iterate);
        T::new(0.5) * dot(&iterate.gradient, &self.preconditioned)
    }

    #[kernel]
    fn find(&mut self, problem: &Problem<T>, _: &Convergence<T>, state: &mut SolverState<T>) {
        let (iterate, direction) = (&state.iterate, &mut state.ray.direction);
        if !self.is_current {
            self.precondition(problem, iterate);
        }
        let mut beta = T::ZERO;
        if self.started {
            let before = dot(&self.gradient, &self.last);
            let overlap = dot(&iterate.gradient, &self.last);
            let now = dot(&iterate.gradient, &self.preconditioned);
            let orthogonal = overlap.abs().lt(T::new(OVERLAP) * now);
            let conjugate = orthogonal & before.gt(T::ZERO);
            beta = T::select(conjugate, (now - overlap) / before, T::ZERO);
        } else {
            direction.clear();
            direction.resize(problem.nv(), T::ZERO);
        }
        for (d, &p) in direction.iter_mut().zip(&self.preconditioned) {
            *d = beta * *d - p;
        }
        self.gradient.clear();
        self.gradient.extend_from_slice(&iterate.gradient);
        self.started = true;
    }
}
