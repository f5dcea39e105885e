//! The solver: selects the parts of a problem that are solved together, and stores the results.
//!
//! Solves are compiled with this crate; a crate that steps simulations calls them without compiling them again.

use crate::check::check_length;
use crate::descent::SolverState;
use crate::error::ProblemError;
use crate::islands::{Islands, Job};
use crate::options::{Settings, Switch};
use crate::problem::Problem;
use crate::results::Results;
use crate::stats::SolveStats;
use crate::stopwatch::SolveClock;
use crate::threads::Threads;
use crate::tree::{Tree, TreeFactor, TreeMatrix};
use crate::workspace::Workspace;
use clench_math::{CompiledKernels, KernelTable, Real};
use std::sync::LazyLock;

/// Solves [`Problem`]s and reuses its memory between solves.
///
/// A solve does not allocate once problems of this size have been solved.
#[derive(Clone, Debug)]
pub struct Solver<T: Real> {
    results: Results<T>,
    whole: Workspace<T>,
    islands: Islands<T>,
    kernels: SolverKernels<T>,
}

impl<T: Real> Solver<T> {
    /// Creates a solver with memory for the results of problems over `tree`. The calling crate compiles the solver for
    /// `T`.
    pub fn new(tree: &Tree) -> Self {
        Self::with_kernels(tree, SolverKernels::of_caller())
    }

    /// Creates a solver in a number type that [`Scalar::in_lanes`](clench_math::Scalar::in_lanes) passes to tasks. This
    /// crate has compiled the solver for it.
    ///
    /// # Panics
    /// Panics if `T` is another type.
    pub fn compiled(tree: &Tree) -> Self {
        Self::with_kernels(tree, SolverKernels::of_this_crate())
    }

    #[cold] // Compiled for size.
    #[inline(never)]
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

    /// Sets the threads that share the work of later solves: islands, and the Hessian of a large one. Results stay the
    /// same to the bit. (With lanes, islands are solved one after the other.)
    pub fn set_threads(&mut self, threads: Threads) {
        self.whole.state.threads = threads;
    }

    /// Solves the problem. `warmstart` (length nv) is used if it costs less than the unconstrained acceleration.
    ///
    /// # Errors
    /// Returns an error if the warm start has the wrong length, or arrays or blocks of the problem have impossible
    /// sizes.
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

    /// Computes the constraint forces at a given acceleration (length nv), independent of the unconstrained one.
    /// [`force`](Self::force), [`qfrc_constraint`](Self::qfrc_constraint) and [`edge_forces`](Self::edge_forces) then
    /// return them. Nothing is minimised, and the statistics are reset.
    ///
    /// # Errors
    /// Returns an error if the acceleration has the wrong length, or arrays or blocks of the problem have impossible
    /// sizes.
    pub fn evaluate(&mut self, problem: &Problem<T>, qacc: &[T]) -> Result<(), ProblemError> {
        (self.kernels.evaluate)(self, problem, qacc)
    }

    /// Calls [`TreeFactor::factor`] as compiled for this solver.
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

    /// Returns the minimiser: the generalized acceleration, length nv.
    pub fn qacc(&self) -> &[T] {
        &self.results.qacc
    }
    /// Returns the constraint force of each row in block coordinates (for a pyramid: contact-frame rows, the sum of its
    /// edges).
    pub fn force(&self) -> &[T] {
        &self.results.force
    }
    /// Returns the constraint forces, so that a caller that knows them without a solve can set them.
    pub fn force_mut(&mut self) -> &mut Vec<T> {
        &mut self.results.force
    }
    /// Returns Jᵀ f, length nv.
    pub fn qfrc_constraint(&self) -> &[T] {
        &self.results.qfrc_constraint
    }
    /// Returns the forces along the 2 (dim − 1) edges of pyramid `block` of the last solved problem, in the order y₀ +
    /// μ₁y₁, y₀ − μ₁y₁, y₀ + μ₂y₂, ...; empty for other costs.
    pub fn edge_forces(&self, problem: &Problem<T>, block: usize) -> &[T] {
        let b = &problem.jacobian.blocks[block];
        if b.cost.has_edges() {
            &self.results.edges[b.active_range()]
        } else {
            &[]
        }
    }
    /// Returns the clock, which measures the time of solves by [`SolvePart`](crate::stopwatch::SolvePart) once it runs.
    pub fn clock(&mut self) -> &mut SolveClock {
        &mut self.whole.state.clock
    }
    /// Returns the statistics of the last solve.
    pub fn stats(&self) -> &SolveStats<T> {
        &self.results.stats
    }
}

type Solve<T> =
    fn(&mut Solver<T>, &Problem<T>, &Settings, Option<&[T]>) -> Result<(), ProblemError>;
type Evaluate<T> = fn(&mut Solver<T>, &Problem<T>, &[T]) -> Result<(), ProblemError>;
type Factor<T> = fn(&mut TreeFactor<T>, &Tree, &TreeMatrix<T>) -> <T as Real>::Mask;

/// The functions that a [`Solver`] runs.
#[derive(Clone, Copy, Debug)]
struct SolverKernels<T: Real> {
    solve: Solve<T>,
    evaluate: Evaluate<T>,
    factor: Factor<T>,
}

impl<T: Real> SolverKernels<T> {
    /// Returns the kernels compiled in the caller's crate.
    fn of_caller() -> Self {
        SolverKernels {
            solve: Solver::run,
            evaluate: Solver::run_evaluation,
            factor: TreeFactor::factor,
        }
    }

    /// Returns the kernels compiled in this crate.
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

/// Returns the compiled kernels; not generic, so that it is compiled here.
#[inline(never)]
fn compiled() -> &'static CompiledKernels {
    static COMPILED: LazyLock<CompiledKernels> = LazyLock::new(CompiledKernels::new::<SolverTable>);
    &COMPILED
}
