//! The derivative of the minimiser, by the implicit function theorem.
//!
//! The minimiser a* of a problem whose data depend on θ satisfies g(a*, θ) = 0. Its derivative follows from those of
//! the gradient, H = ∂g/∂a among them, which Newton's method factors anyway:
//!
//! ```text
//! H da + ∂g/∂θ dθ = 0
//! ```
//!
//! So a problem in dual numbers is first solved for its values. The gradient at the constant a*, evaluated in dual
//! numbers, has the derivatives ∂g/∂θ dθ: those of M, a_unc, J, aref, R and the shapes of cones, through the same costs
//! that a solve evaluates. A second evaluation, at a* with its derivatives, gives the forces theirs.
//!
//! In a problem with Coulomb blocks, friction is also limited by the normal force of the solution, λ = f(a). With the B
//! and D of [`prediction`](crate::prediction), that adds −B D J_n da to the derivative of the gradient:
//!
//! ```text
//! (H − B D J_n) da + ∂g/∂θ dθ = 0
//! ```

mod coulomb;
mod error_bound;

use crate::cg::Cg;
use crate::descent::{Direction, SolverState, minimise};
use crate::iterate::Iterate;
use crate::newton::Newton;
use crate::options::{ConstraintSolver, Settings};
use crate::problem::{Part, Problem};
use crate::stats::{SolveStats, Status};
use crate::transfer::Transfer;
use crate::tree::Tree;
use clench_math::{Mask, Real, kernel};
use coulomb::Sliding;
pub use error_bound::{ErrorBound, ErrorBounds};
use std::any::Any;
use std::sync::Arc;

/// The values of a problem in dual numbers, and their solve.
#[derive(Clone, Debug)]
pub(crate) struct Implicit<V: Real> {
    problem: Problem<V>,
    /// The next problem: solved and factored only if it differs from the last one.
    next: Problem<V>,
    state: SolverState<V>,
    newton: Newton<V>,
    cg: Cg<V>,
    sliding: Sliding<V>,
    /// The settings of the last solve whose Hessian could be factored.
    solved: Option<Settings>,
    warmstart: Vec<V>,
    /// 0, 1, ...: the dofs and the blocks.
    identity: Vec<u32>,
    /// The lanes of each block: all.
    acting: Vec<V::Mask>,
    scratch: Vec<V>,
}

impl<V: Real> Default for Implicit<V> {
    fn default() -> Self {
        Implicit {
            problem: Problem::new(Arc::new(Tree::dense(0))),
            next: Problem::new(Arc::new(Tree::dense(0))),
            state: SolverState::default(),
            newton: Newton::default(),
            cg: Cg::default(),
            sliding: Sliding::default(),
            solved: None,
            warmstart: Vec::new(),
            identity: Vec::new(),
            acting: Vec::new(),
            scratch: Vec::new(),
        }
    }
}

/// Memory of a type that the number type selects. Plain numbers need none, so it has no code for them.
#[derive(Debug, Default)]
pub(crate) struct Memory(Option<Box<dyn Any + Send + Sync>>);

impl Memory {
    /// Returns the memory, created on first use.
    pub(crate) fn get<X: Any + Default + Send + Sync>(&mut self) -> &mut X {
        let memory = self.0.get_or_insert_with(|| Box::<X>::default());
        (memory.downcast_mut()).expect("one number type uses the memory")
    }
}

impl Clone for Memory {
    /// Creates empty memory.
    fn clone(&self) -> Self {
        Memory::default()
    }
}

/// The transfer of values: results have no derivatives.
#[derive(Clone, Copy)]
struct Values;

impl<T: Real> Transfer<T, T::Value> for Values {
    #[inline(always)]
    fn convert(self, x: T) -> T::Value {
        x.value()
    }
    #[inline(always)]
    fn convert_in(self, lanes: T::Mask, x: T, absent: T) -> T::Value {
        T::select(lanes, x, absent).value()
    }
    #[inline(always)]
    fn convert_back(self, x: T::Value) -> T {
        T::from_value(x)
    }
}

impl<V: Real<Value = V>> Implicit<V> {
    /// Solves a problem, and differentiates its minimiser and forces. The iterate then is the solution.
    #[kernel]
    pub fn minimise<T: Real<Value = V, Mask = V::Mask>>(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
        iterate: &mut Iterate<T>,
        stats: &mut SolveStats<T>,
    ) {
        if !self.solve_values(problem, settings, warmstart) {
            stats.status = Status::TooLarge.code();
            return;
        }
        let all = T::Mask::splat(true);
        stats.combine(&self.state.stats, all, Values);
        iterate.qacc.clear();
        let solution = &self.state.iterate.qacc;
        (iterate.qacc).extend(solution.iter().map(|&x| T::from_value(x)));
        iterate.evaluate_at_qacc(problem);
        let (gradient, scratch) = (&mut iterate.gradient, &mut self.scratch);
        self.newton.solve_tangents(gradient, scratch);
        if !self.sliding.is_empty() {
            T::map_tangents(gradient, scratch, |x| {
                self.sliding.correct(&self.problem, x)
            });
        }
        for (a, &x) in iterate.qacc.iter_mut().zip(&iterate.gradient) {
            let value = a.value();
            *a = -x;
            a.set_value(value);
        }
        let qacc = std::mem::take(&mut iterate.qacc);
        iterate.start_at(problem, &qacc);
        iterate.differentiate(problem);
        let solved = &self.state.iterate;
        for (to, from) in [
            (&mut iterate.force, &solved.force),
            (&mut iterate.residual, &solved.residual),
            (&mut iterate.qfrc_constraint, &solved.qfrc_constraint),
        ] {
            for (to, &from) in to.iter_mut().zip(from) {
                to.set_value(from);
            }
        }
    }

    /// Minimises the values of the problem and factors the Hessian; noslip is left to the caller. Returns false if that
    /// needs larger matrices than the settings allow.
    fn solve_values<T: Real<Value = V, Mask = V::Mask>>(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
    ) -> bool {
        let (nv, nblock) = (problem.nv(), problem.nblock());
        self.identity.clear();
        self.identity.extend(0..nv.max(nblock) as u32);
        self.acting.clear();
        self.acting.resize(nblock, T::Mask::splat(true));
        let part = Part {
            dofs: &self.identity[..nv],
            local: &self.identity[..nv],
            blocks: &self.identity[..nblock],
            acting: &self.acting,
            lanes: T::Mask::splat(true),
        };
        self.next.gather(problem, &part, Values);
        let settings = Settings {
            noslip_iterations: 0,
            ..*settings
        };
        if self.solved == Some(settings) && self.next.equals(&self.problem) {
            return true;
        }
        std::mem::swap(&mut self.problem, &mut self.next);
        self.warmstart.clear();
        let warmstart = warmstart.map(|warmstart| {
            self.warmstart.extend(warmstart.iter().map(|x| x.value()));
            &self.warmstart[..]
        });
        let (problem, state) = (&self.problem, &mut self.state);
        state.stats = SolveStats::default();
        match settings.constraint_solver {
            ConstraintSolver::Newton => {
                minimise(problem, &settings, warmstart, &mut self.newton, state)
            }
            ConstraintSolver::Cg => minimise(problem, &settings, warmstart, &mut self.cg, state),
        }
        let fits = self.newton.prepare(&self.problem, &settings);
        self.solved = fits.then_some(settings);
        if fits {
            let SolverState {
                iterate,
                threads,
                clock,
                ..
            } = &mut self.state;
            let (problem, all) = (&self.problem, V::Mask::splat(true));
            self.newton.factor(problem, iterate, all, threads, clock);
            self.sliding.prepare(problem, iterate, &mut self.newton);
        }
        fits
    }
}
