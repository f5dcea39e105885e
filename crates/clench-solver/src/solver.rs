//! The solver.

use crate::{Problem, ProblemError, Settings, SolveStats, Tree};
use clench_math::Real;

/// Solves [`Problem`]s; keeps its memory between solves.
#[derive(Clone, Debug)]
pub struct Solver<T> {
    qacc: Vec<T>,
    force: Vec<T>,
    qfrc_constraint: Vec<T>,
    stats: SolveStats<T>,
}

impl<T: Real> Solver<T> {
    /// A solver with memory for problems over `tree`.
    pub fn new(tree: &Tree) -> Self {
        let zeros = vec![T::ZERO; tree.nv()];
        Solver {
            qacc: zeros.clone(),
            force: Vec::new(),
            qfrc_constraint: zeros,
            stats: SolveStats::default(),
        }
    }

    /// Minimises. `warmstart` (length nv) is taken where it costs less than the unconstrained acceleration.
    ///
    /// # Errors
    /// A warm start of the wrong length.
    pub fn solve(
        &mut self,
        _problem: &Problem<T>,
        _settings: &Settings,
        _warmstart: Option<&[T]>,
    ) -> Result<&SolveStats<T>, ProblemError> {
        todo!("lands next")
    }

    /// The minimiser: generalized acceleration, length nv.
    pub fn qacc(&self) -> &[T] {
        &self.qacc
    }
    /// Constraint force of each row in block coordinates (for a pyramid: contact-frame rows, the sum of its edges).
    pub fn force(&self) -> &[T] {
        &self.force
    }
    /// Jᵀ f, length nv.
    pub fn qfrc_constraint(&self) -> &[T] {
        &self.qfrc_constraint
    }
    /// Forces along the 2 (dim − 1) edges of pyramid `block`, in the order y₀ + μ₁y₁, y₀ − μ₁y₁, y₀ + μ₂y₂, ...;
    /// empty for other costs.
    pub fn edge_forces(&self, _problem: &Problem<T>, _block: usize) -> &[T] {
        todo!("lands next")
    }
    /// Statistics of the last solve.
    pub fn stats(&self) -> &SolveStats<T> {
        &self.stats
    }
}
