//! The solver: which parts of a problem are solved together, and where the results lie.
//!
//! Solves are compiled with this crate: a crate that steps simulations calls them, and does not compile them anew.

use crate::check::check_length;
use crate::descent::SolverState;
use crate::islands::{Islands, Job};
use crate::results::Results;
use crate::stopwatch::SolveClock;
use crate::workspace::Workspace;
use crate::{
    Cost, Problem, ProblemError, Settings, SolveStats, Switch, Threads, Tree, TreeFactor,
    TreeMatrix,
};
use clench_math::{CompiledKernels, KernelTable, Real};
use std::sync::LazyLock;

/// Solves [`Problem`]s; keeps its memory between solves.
///
/// A solve allocates nothing once problems of this size have been seen.
#[derive(Clone, Debug)]
pub struct Solver<T: Real> {
    results: Results<T>,
    whole: Workspace<T>,
    islands: Islands<T>,
    kernels: SolverKernels<T>,
}

impl<T: Real> Solver<T> {
    /// A solver, with memory for the results of problems over `tree`. The crate that calls this compiles the solver for `T`.
    pub fn new(tree: &Tree) -> Self {
        Self::with_kernels(tree, SolverKernels::of_caller())
    }

    /// The same in a number type that [`Scalar::in_lanes`](clench_math::Scalar::in_lanes) gives to tasks: this crate has compiled the
    /// solver for it.
    ///
    /// # Panics
    /// Where `T` is another type.
    pub fn compiled(tree: &Tree) -> Self {
        Self::with_kernels(tree, SolverKernels::of_this_crate())
    }

    fn with_kernels(tree: &Tree, kernels: SolverKernels<T>) -> Self {
        let zeros = vec![T::ZERO; tree.nv()];
        Solver {
            results: Results {
                qacc: zeros.clone(),
                qfrc_constraint: zeros,
                ..Results::default()
            },
            whole: Workspace::default(),
            islands: Islands::default(),
            kernels,
        }
    }

    /// Has threads share the work of solves from now on: islands, and the Hessian of a large one. Results stay the same to the bit. (Of
    /// lanes, islands are solved one after the other.)
    pub fn set_threads(&mut self, threads: Threads) {
        self.whole.state.threads = threads;
    }

    /// Minimises. `warmstart` (length nv) is taken where it costs less than the unconstrained acceleration.
    ///
    /// # Errors
    /// A warm start of the wrong length, or arrays or blocks of the problem that have impossible sizes.
    pub fn solve(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
    ) -> Result<&SolveStats<T>, ProblemError> {
        (self.kernels.solve)(self, problem, settings, warmstart)?;
        Ok(&self.results.stats)
    }

    fn run(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
    ) -> Result<(), ProblemError> {
        problem.check_sizes()?;
        if let Some(warm) = warmstart {
            check_length("warmstart", warm.len(), problem.nv())?;
        }
        let warmstart = warmstart.filter(|_| settings.warmstart);
        let parts = settings.islands != Switch::Off && problem.tree().ntree() > 1;
        if problem.nrow() == 0 {
            self.results.reset(problem);
        } else if parts && self.islands.find(problem) {
            self.results.reset(problem);
            let SolverState { clock, threads, .. } = &mut self.whole.state;
            let job = Job {
                problem,
                settings,
                warmstart,
                threads,
            };
            self.islands.solve(&job, clock, &mut self.results);
        } else {
            self.whole.run(problem, settings, warmstart);
            self.results.set(&self.whole);
        }
        Ok(())
    }

    /// The constraint forces at an acceleration (length nv) that is known, whatever the unconstrained one: what
    /// [`force`](Self::force), [`qfrc_constraint`](Self::qfrc_constraint) and [`edge_forces`](Self::edge_forces) then give.
    /// Nothing is minimised, and the statistics are those of no solve.
    ///
    /// # Errors
    /// An acceleration of the wrong length, or arrays or blocks of the problem that have impossible sizes.
    pub fn evaluate(&mut self, problem: &Problem<T>, qacc: &[T]) -> Result<(), ProblemError> {
        (self.kernels.evaluate)(self, problem, qacc)
    }

    /// As [`TreeFactor::factor`], by the code that this solver runs.
    pub fn factor(
        &self,
        factor: &mut TreeFactor<T>,
        tree: &Tree,
        matrix: &TreeMatrix<T>,
    ) -> T::Mask {
        (self.kernels.factor)(factor, tree, matrix)
    }

    fn run_evaluation(&mut self, problem: &Problem<T>, qacc: &[T]) -> Result<(), ProblemError> {
        problem.check_sizes()?;
        check_length("qacc", qacc.len(), problem.nv())?;
        self.whole.evaluate(problem, qacc);
        self.results.set(&self.whole);
        Ok(())
    }

    /// The minimiser: generalized acceleration, length nv.
    pub fn qacc(&self) -> &[T] {
        &self.results.qacc
    }
    /// Constraint force of each row in block coordinates (for a pyramid: contact-frame rows, the sum of its edges).
    pub fn force(&self) -> &[T] {
        &self.results.force
    }
    /// Jᵀ f, length nv.
    pub fn qfrc_constraint(&self) -> &[T] {
        &self.results.qfrc_constraint
    }
    /// Forces along the 2 (dim − 1) edges of pyramid `block` of the problem last solved, in the order y₀ + μ₁y₁,
    /// y₀ − μ₁y₁, y₀ + μ₂y₂, ...; empty for other costs.
    pub fn edge_forces(&self, problem: &Problem<T>, block: usize) -> &[T] {
        let b = &problem.jacobian.blocks[block];
        if b.cost == Cost::Pyramid {
            &self.results.edges[b.active_range()]
        } else {
            &[]
        }
    }
    /// Where the time of solves goes once it runs, by [`SolvePart`](crate::stopwatch::SolvePart).
    pub fn clock(&mut self) -> &mut SolveClock {
        &mut self.whole.state.clock
    }
    /// Statistics of the last solve.
    pub fn stats(&self) -> &SolveStats<T> {
        &self.results.stats
    }
}

type Solve<T> =
    fn(&mut Solver<T>, &Problem<T>, &Settings, Option<&[T]>) -> Result<(), ProblemError>;
type Evaluate<T> = fn(&mut Solver<T>, &Problem<T>, &[T]) -> Result<(), ProblemError>;
type Factor<T> = fn(&mut TreeFactor<T>, &Tree, &TreeMatrix<T>) -> <T as Real>::Mask;

/// What a [`Solver`] runs.
#[derive(Clone, Copy, Debug)]
struct SolverKernels<T: Real> {
    solve: Solve<T>,
    evaluate: Evaluate<T>,
    factor: Factor<T>,
}

impl<T: Real> SolverKernels<T> {
    /// Those of the caller's crate.
    fn of_caller() -> Self {
        SolverKernels {
            solve: Solver::run,
            evaluate: Solver::run_evaluation,
            factor: TreeFactor::factor,
        }
    }

    /// Those of this crate.
    fn of_this_crate() -> Self {
        compiled().table::<SolverTable, T>()
    }
}

struct SolverTable;

impl KernelTable for SolverTable {
    type Of<T: Real> = SolverKernels<T>;
    fn of<T: Real>() -> SolverKernels<T> {
        SolverKernels::of_caller()
    }
}

/// Not generic, so that it is compiled here.
#[inline(never)]
fn compiled() -> &'static CompiledKernels {
    static COMPILED: LazyLock<CompiledKernels> = LazyLock::new(CompiledKernels::new::<SolverTable>);
    &COMPILED
}
