//! `clench.SolverStats`.

use clench::solver::LaneStats;
use pyo3::prelude::*;

/// Statistics of the last solve.
///
/// Norms and costs are divided by mean inertia times nv, unless stated otherwise.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct SolverStats {
    /// str : Outcome: "unconstrained" (no constraint acted), "proven" (the starting point was good enough),
    /// "converged", "no_progress" (the working precision allows no more), "iteration_limit", "non_finite" or
    /// "too_large" (for the model's budget). Over islands, the worst.
    status: &'static str,
    /// int : Number of iterations; over islands, the maximum.
    iterations: usize,
    /// float : Norm of the gradient; over islands, the maximum.
    gradient: f64,
    /// float : Last improvement of the cost; over islands, the maximum.
    improvement: f64,
    /// float : The duality gap, an upper bound of cost minus minimum, in the units of the cost.
    gap: f64,
    /// float : Largest difference between the normal force of a contact and the one that limits its friction, N. Zero
    /// where Coulomb's law holds, and in the convex contact model; over islands, the maximum.
    normal_residual: f64,
    /// int : Number of changes of a constraint's state (a contact began to slip, a limit became inactive), in all
    /// iterations.
    active_set_changes: usize,
    /// int : Number of line-search evaluations.
    ls_evaluations: usize,
    /// int : Number of Hessian factorizations from scratch.
    factorizations: usize,
    /// int : Number of rank-one updates of a factored Hessian.
    updates: usize,
    /// int : Number of noslip sweeps.
    noslip_iterations: usize,
    /// int : Number of islands that were solved separately; 1 if islands are not used and constraints act.
    islands: usize,
}

impl SolverStats {
    /// Returns the outcome.
    pub(crate) fn status(&self) -> &'static str {
        self.status
    }

    /// Returns the duality gap.
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
            normal_residual: stats.normal_residual,
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
