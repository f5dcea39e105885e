//! Conjugate gradients, preconditioned by the mass matrix (Polak–Ribière).
//!
//! The direction starts anew from −M⁻¹g where β would be negative, and where consecutive gradients are far from orthogonal
//! (Powell, *Restart procedures for the conjugate gradient method*, 1977):
//!
//! ```text
//! |gᵀM⁻¹g_prev| ≥ 0.2 gᵀM⁻¹g
//! ```
//!
//! Over a quadratic they would be orthogonal. Where they are not, the cost has changed its piece on the way, and the old
//! direction is conjugate for a Hessian that no longer holds.

use crate::descent::{Convergence, Direction, SolverState};
use crate::iterate::{Iterate, dot};
use crate::{Problem, Settings};
use clench_math::{Real, kernel};

/// Powell's bound: consecutive gradients that overlap by this part of the new one are far from orthogonal.
const OVERLAP: f64 = 0.2;

/// Two consecutive gradients, and their images under M⁻¹.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cg<T> {
    /// The gradient that the last direction was made from.
    gradient: Vec<T>,
    /// M⁻¹ times that one.
    last: Vec<T>,
    /// M⁻¹ times the present one, and whether it is known.
    preconditioned: Vec<T>,
    fresh: bool,
    /// Whether there was a direction in this solve.
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
        self.fresh = true;
    }
}

impl<T: Real> Direction<T> for Cg<T> {
    const NEWTON: bool = false;
    const PATIENCE: f64 = 20.0;

    #[inline(always)]
    fn prepare(&mut self, _: &Problem<T>, _: &Settings) -> bool {
        self.started = false;
        self.fresh = false;
        true
    }

    #[inline(always)]
    fn restart(&mut self, mask: T::Mask) {
        for g in &mut self.gradient {
            *g = T::select(mask, T::ZERO, *g);
        }
        self.fresh = false;
    }

    /// The next direction needs M⁻¹g anyway, so the gap costs a product.
    #[inline(always)]
    fn gap(&mut self, problem: &Problem<T>, iterate: &Iterate<T>) -> T {
        std::mem::swap(&mut self.last, &mut self.preconditioned);
        self.precondition(problem, iterate);
        T::new(0.5) * dot(&iterate.gradient, &self.preconditioned)
    }

    #[kernel]
    fn find(&mut self, problem: &Problem<T>, _: &Convergence<T>, state: &mut SolverState<T>) {
        let (iterate, direction) = (&state.iterate, &mut state.ray.direction);
        if !self.fresh {
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
