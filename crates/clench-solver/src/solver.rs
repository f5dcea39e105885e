//! The solver.

use crate::cg::Cg;
use crate::costs::Pyramid;
use crate::descent::minimise;
use crate::iterate::Iterate;
use crate::line_search::Ray;
use crate::newton::Newton;
use crate::problem::check_length;
use crate::{ConstraintSolver, Cost, Problem, ProblemError, Settings, SolveStats, Status, Tree};
use clench_math::Real;

/// Solves [`Problem`]s; keeps its memory between solves.
#[derive(Clone, Debug)]
pub struct Solver<T: Real> {
    iterate: Iterate<T>,
    ray: Ray<T>,
    newton: Newton<T>,
    cg: Cg<T>,
    /// Edge forces of pyramids, at the index of their pieces.
    edges: Vec<T>,
    stats: SolveStats<T>,
}

impl<T: Real> Solver<T> {
    /// A solver with memory for problems over `tree`.
    pub fn new(tree: &Tree) -> Self {
        let zeros = vec![T::ZERO; tree.nv()];
        Solver {
            iterate: Iterate {
                qacc: zeros.clone(),
                qfrc_constraint: zeros,
                ..Default::default()
            },
            ray: Ray::default(),
            newton: Newton::default(),
            cg: Cg::default(),
            edges: Vec::new(),
            stats: SolveStats::default(),
        }
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
        problem.check_sizes()?;
        if let Some(warm) = warmstart {
            check_length("warmstart", warm.len(), problem.nv())?;
        }
        self.stats = SolveStats::default();
        let warmstart = warmstart.filter(|_| settings.warmstart);
        let Solver {
            iterate,
            ray,
            newton,
            cg,
            stats,
            ..
        } = self;
        if problem.nrow() == 0 {
            iterate.start(problem, None, ray);
            stats.status = Status::Unconstrained.code();
        } else {
            match settings.constraint_solver {
                ConstraintSolver::Newton => {
                    minimise(problem, settings, warmstart, iterate, ray, newton, stats)
                }
                ConstraintSolver::Cg => {
                    minimise(problem, settings, warmstart, iterate, ray, cg, stats)
                }
            }
        }
        self.read_edges(problem);
        Ok(&self.stats)
    }

    fn read_edges(&mut self, problem: &Problem<T>) {
        self.edges.resize(problem.npiece, T::ZERO);
        for b in problem
            .jacobian
            .blocks
            .iter()
            .filter(|b| b.cost == Cost::Pyramid)
        {
            let edges = &mut self.edges[b.piece..b.piece + 2 * (b.dim - 1)];
            Pyramid::edge_forces(problem.rows(b), &self.iterate.residual[b.rows()], edges);
        }
    }

    /// The minimiser: generalized acceleration, length nv.
    pub fn qacc(&self) -> &[T] {
        &self.iterate.qacc
    }
    /// Constraint force of each row in block coordinates (for a pyramid: contact-frame rows, the sum of its edges).
    pub fn force(&self) -> &[T] {
        &self.iterate.force
    }
    /// Jᵀ f, length nv.
    pub fn qfrc_constraint(&self) -> &[T] {
        &self.iterate.qfrc_constraint
    }
    /// Forces along the 2 (dim − 1) edges of pyramid `block`, in the order y₀ + μ₁y₁, y₀ − μ₁y₁, y₀ + μ₂y₂, ...;
    /// empty for other costs.
    pub fn edge_forces(&self, problem: &Problem<T>, block: usize) -> &[T] {
        let b = &problem.jacobian.blocks[block];
        let count = if b.cost == Cost::Pyramid {
            2 * (b.dim - 1)
        } else {
            0
        };
        &self.edges[b.piece..b.piece + count]
    }
    /// Statistics of the last solve.
    pub fn stats(&self) -> &SolveStats<T> {
        &self.stats
    }
}
