//! The memory of a solve of one whole problem.

use crate::cg::Cg;
use crate::costs::{Cost, Pyramid};
use crate::descent::{SolverState, minimise, trace};
use crate::implicit::{Implicit, Memory};
use crate::newton::Newton;
use crate::noslip::Noslip;
use crate::options::{ConstraintSolver, Settings};
use crate::problem::Problem;
use crate::stats::{SolveStats, Status};
use clench_math::{Real, kernel};

/// Memory for problems solved as a whole.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace<T: Real> {
    pub state: SolverState<T>,
    /// Edge forces of pyramids, at the index of their entries in the active set.
    pub edges: Vec<T>,
    newton: Newton<T>,
    cg: Cg<T>,
    noslip: Noslip<T>,
    /// The solve of the values of dual numbers.
    implicit: Memory,
}

impl<T: Real> Workspace<T> {
    /// Minimises, then removes slip if the settings request it.
    #[kernel]
    pub fn run(&mut self, problem: &Problem<T>, settings: &Settings, warmstart: Option<&[T]>) {
        self.state.stats = SolveStats {
            islands: T::ONE,
            ..SolveStats::default()
        };
        self.minimise(problem, settings, warmstart);
        self.find_edge_forces(problem);
        let SolverState { iterate, stats, .. } = &mut self.state;
        // Noslip stores a response of all dofs to each row.
        let responses = problem.nrow().saturating_mul(problem.nv());
        if settings.noslip_iterations > 0 && responses > settings.max_matrix {
            stats.status = Status::TooLarge.code();
        } else if settings.noslip_iterations > 0 {
            let scale = T::ONE / trace(problem);
            self.noslip
                .run(problem, settings, scale, iterate, &mut self.edges, stats);
        }
    }

    #[inline(always)]
    fn minimise(&mut self, problem: &Problem<T>, settings: &Settings, warmstart: Option<&[T]>) {
        let Workspace {
            state, newton, cg, ..
        } = self;
        if T::IS_DUAL {
            let implicit: &mut Implicit<T::Value> = self.implicit.get();
            let SolverState { iterate, stats, .. } = state;
            implicit.minimise(problem, settings, warmstart, iterate, stats);
            return;
        }
        match settings.constraint_solver {
            ConstraintSolver::Newton => minimise(problem, settings, warmstart, newton, state),
            ConstraintSolver::Cg => minimise(problem, settings, warmstart, cg, state),
        }
    }

    /// Computes the constraint forces at an acceleration, and Jᵀ f. Nothing is minimised.
    #[kernel]
    pub fn evaluate(&mut self, problem: &Problem<T>, qacc: &[T]) {
        let SolverState { iterate, stats, .. } = &mut self.state;
        *stats = SolveStats::default();
        iterate.start_at(problem, qacc);
        iterate.differentiate(problem);
        self.find_edge_forces(problem);
    }

    /// Computes the forces along the edges of pyramids from the residuals.
    #[inline(always)]
    fn find_edge_forces(&mut self, problem: &Problem<T>) {
        self.edges.resize(problem.nactive, T::ZERO);
        let blocks = problem.jacobian.blocks.iter();
        for b in blocks.filter(|b| b.cost == Cost::Pyramid) {
            let edges = &mut self.edges[b.active_start..b.active_start + 2 * (b.dim - 1)];
            let residual = &self.state.iterate.residual[b.rows()];
            Pyramid::edge_forces(problem.rows(b), residual, edges);
        }
    }
}
