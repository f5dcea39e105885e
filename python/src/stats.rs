//! `clench.SolverStats`.

use clench::solver::LaneStats;
use pyo3::prelude::*;

/// How the last solve went.
///
/// Norms and costs are over mean inertia times nv, unless said otherwise.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct SolverStats {
    /// str : How it ended: "unconstrained" (no constraint acted), "proven" (the starting point was good enough), "converged",
    /// "no_progress" (the working precision allows no more), "iteration_limit", "non_finite" or "too_large" (for the model's budget). Over islands, the
    /// worst.
    status: &'static str,
    /// int : Iterations; over islands, the most.
    iterations: usize,
    /// float : Norm of the gradient; over islands, the largest.
    gradient: f64,
    /// float : Last improvement of the cost; over islands, the largest.
    improvement: f64,
    /// float : The duality gap, an upper bound of cost minus minimum, in the units of the cost.
    gap: f64,
    /// int : How often a constraint changed its piece (a contact began to slip, a limit let go), in all iterations.
    active_set_changes: usize,
    /// int : Evaluations of line searches.
    ls_evaluations: usize,
    /// int : Hessians factored from scratch.
    factorizations: usize,
    /// int : Rank-one updates of a factored Hessian.
    updates: usize,
    /// int : Sweeps that removed slip.
    noslip_iterations: usize,
    /// int : Parts that were solved separately; 1 where islands are not used and constraints act.
    islands: usize,
}

impl SolverStats {
    /// How it ended.
    pub(crate) fn status(&self) -> &'static str {
        self.status
    }

    /// The duality gap.
    pub(crate) fn gap(&self) -> f64 {
        self.gap
    }
}

impl From<LaneStats> for SolverStats {
    fn from(stats: LaneStats) -> Self {
        SolverStats {
            status: stats.status.name(),
            iterations: stats.iterations,
            gradient: stats.gradient,
            improvement: stats.improvement,
            gap: stats.gap,
            active_set_changes: stats.active_set_changes,
            ls_evaluations: stats.ls_evaluations,
            factorizations: stats.factorizations,
            updates: stats.updates,
            noslip_iterations: stats.noslip_iterations,
            islands: stats.islands,
        }
    }
}

#[pymethods]
impl SolverStats {
    fn __repr__(&self) -> String {
        format!(
            "SolverStats(status='{}', iterations={}, gradient={:.1e}, improvement={:.1e}, gap={:.1e})",
            self.status, self.iterations, self.gradient, self.improvement, self.gap
        )
    }
}
