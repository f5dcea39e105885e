//! Lanes taken apart: where environments have different islands, each is solved alone.

use crate::{Problem, ProblemError, Settings, SolveClock, SolveStats, Solver, Tree};
use clench_math::Real;
use std::sync::Arc;

/// Memory for one lane's problem.
#[derive(Clone, Debug)]
pub(crate) struct Lane<T: Real> {
    problem: Problem<T::Scalar>,
    solver: Solver<T::Scalar>,
    warmstart: Vec<T::Scalar>,
    /// The blocks that the lane has.
    blocks: Vec<u32>,
}

/// Where the results of a lane go.
pub(crate) struct Results<'a, T> {
    pub qacc: &'a mut [T],
    pub force: &'a mut [T],
    pub edges: &'a mut [T],
    pub qfrc_constraint: &'a mut [T],
    pub stats: &'a mut SolveStats<T>,
}

impl<T: Real> Lane<T> {
    pub fn new() -> Self {
        let tree = Arc::new(Tree::dense(0));
        Lane {
            solver: Solver::new(&tree),
            problem: Problem::new(tree),
            warmstart: Vec::new(),
            blocks: Vec::new(),
        }
    }

    /// Times its solves.
    pub fn clock(&mut self) -> &mut SolveClock {
        self.solver.clock()
    }

    /// Solves lane `lane` of `problem` and writes its results.
    pub fn solve(
        &mut self,
        problem: &Problem<T>,
        lane: usize,
        settings: &Settings,
        warmstart: Option<&[T]>,
        results: &mut Results<T>,
    ) -> Result<(), ProblemError> {
        self.blocks.clear();
        for (k, block) in problem.blocks().enumerate() {
            if block.d.iter().any(|d| d.lane(lane) > T::Scalar::ZERO) {
                self.blocks.push(k as u32);
            }
        }
        self.problem.gather_lane(problem, lane, &self.blocks);
        let warmstart = warmstart.map(|warm| {
            self.warmstart.clear();
            self.warmstart.extend(warm.iter().map(|w| w.lane(lane)));
            &self.warmstart[..]
        });
        let stats = *self.solver.solve(&self.problem, settings, warmstart)?;
        results.stats.set_lane(lane, &stats);
        scatter(results.qacc, lane, self.solver.qacc());
        scatter(results.qfrc_constraint, lane, self.solver.qfrc_constraint());
        for (local, &k) in self.blocks.iter().enumerate() {
            let b = &problem.jacobian.blocks[k as usize];
            let edges = self.solver.edge_forces(&self.problem, local);
            scatter(
                &mut results.edges[b.piece..b.piece + edges.len()],
                lane,
                edges,
            );
            let force = &self.solver.force()[self.problem.block(local).rows()];
            scatter(&mut results.force[b.rows()], lane, force);
        }
        Ok(())
    }
}

fn scatter<T: Real>(to: &mut [T], lane: usize, from: &[T::Scalar]) {
    for (to, &from) in to.iter_mut().zip(from) {
        to.set_lane(lane, from);
    }
}
