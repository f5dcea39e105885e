//! The solver: which parts of a problem are solved together, and where the results lie.

use crate::check::check_length;
use crate::islands::Islands;
use crate::iterate::all_finite;
use crate::lane::{Lane, Results};
use crate::workspace::Workspace;
use crate::{Cost, Problem, ProblemError, Settings, SolveStats, Status, Stopwatch, Switch, Tree};
use clench_math::{Real, kernel};

/// What a solve spends its time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolvePart {
    /// The better of two starting points, and whether it is good enough already.
    Start,
    /// H.
    Hessian,
    /// Its factorization, or an update of it.
    Factorization,
    /// The direction.
    Direction,
    /// How far to go along it.
    LineSearch,
    /// Costs and gradient at the new point, and whether to stop there.
    Evaluation,
}

impl SolvePart {
    /// How many there are.
    pub const COUNT: usize = 6;
}

/// Times the parts of solves.
pub type SolveClock = Stopwatch<{ SolvePart::COUNT }>;

/// Solves [`Problem`]s; keeps its memory between solves.
///
/// A solve allocates nothing once problems of this size have been seen.
#[derive(Clone, Debug)]
pub struct Solver<T: Real> {
    qacc: Vec<T>,
    force: Vec<T>,
    /// Edge forces of pyramids, at the index of their pieces.
    edges: Vec<T>,
    qfrc_constraint: Vec<T>,
    stats: SolveStats<T>,
    whole: Workspace<T>,
    islands: Islands<T>,
    lane: Option<Box<Lane<T>>>,
}

impl<T: Real> Solver<T> {
    /// A solver, with memory for the results of problems over `tree`.
    pub fn new(tree: &Tree) -> Self {
        let zeros = vec![T::ZERO; tree.nv()];
        Solver {
            qacc: zeros.clone(),
            force: Vec::new(),
            edges: Vec::new(),
            qfrc_constraint: zeros,
            stats: SolveStats::default(),
            whole: Workspace::default(),
            islands: Islands::default(),
            lane: None,
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
        let warmstart = warmstart.filter(|_| settings.warmstart);
        let parts = settings.islands != Switch::Off && problem.tree().ntree() > 1;
        if problem.nrow() == 0 {
            self.reset(problem);
        } else if parts && T::LANES > 1 {
            self.solve_lanes(problem, settings, warmstart)?;
        } else if parts && self.islands.find(problem) {
            self.solve_islands(problem, settings, warmstart);
        } else {
            self.solve_whole(problem, settings, warmstart);
        }
        Ok(&self.stats)
    }

    /// The results of a problem without constraints.
    #[kernel]
    fn reset(&mut self, problem: &Problem<T>) {
        let finite = all_finite(&problem.qacc_smooth);
        let status = T::select(
            finite,
            Status::Unconstrained.code(),
            Status::NonFinite.code(),
        );
        self.stats = SolveStats {
            status,
            ..SolveStats::default()
        };
        copy(&mut self.qacc, &problem.qacc_smooth);
        for (v, len) in [
            (&mut self.force, problem.nrow()),
            (&mut self.edges, problem.npiece),
            (&mut self.qfrc_constraint, problem.nv()),
        ] {
            v.clear();
            v.resize(len, T::ZERO);
        }
    }

    fn solve_whole(&mut self, problem: &Problem<T>, settings: &Settings, warmstart: Option<&[T]>) {
        self.whole.run(problem, settings, warmstart);
        self.stats = self.whole.course.stats;
        copy(&mut self.qacc, &self.whole.course.iterate.qacc);
        copy(&mut self.force, &self.whole.course.iterate.force);
        copy(&mut self.edges, &self.whole.edges);
        copy(
            &mut self.qfrc_constraint,
            &self.whole.course.iterate.qfrc_constraint,
        );
    }

    fn solve_islands(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
    ) {
        self.reset(problem);
        let clock = &mut self.whole.course.clock;
        let (islands, stats) = self.islands.solve(problem, settings, warmstart, clock);
        self.stats.combine(&stats);
        for island in islands {
            let iterate = &island.work.course.iterate;
            for (local, &dof) in island.dofs.iter().enumerate() {
                self.qacc[dof as usize] = iterate.qacc[local];
                self.qfrc_constraint[dof as usize] = iterate.qfrc_constraint[local];
            }
            for (from, &k) in island.problem.jacobian.blocks.iter().zip(&island.blocks) {
                let to = &problem.jacobian.blocks[k as usize];
                self.force[to.rows()].copy_from_slice(&iterate.force[from.rows()]);
                let edges = self.edges[to.piece..]
                    .iter_mut()
                    .zip(&island.work.edges[from.pieces()]);
                edges.for_each(|(to, &from)| *to = from);
            }
        }
    }

    fn solve_lanes(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
    ) -> Result<(), ProblemError> {
        self.reset(problem);
        let lane = self.lane.get_or_insert_with(|| Box::new(Lane::new()));
        let mut results = Results {
            qacc: &mut self.qacc,
            force: &mut self.force,
            edges: &mut self.edges,
            qfrc_constraint: &mut self.qfrc_constraint,
            stats: &mut self.stats,
        };
        let clock = &mut self.whole.course.clock;
        std::mem::swap(lane.clock(), clock);
        let done = (0..T::LANES)
            .try_for_each(|k| lane.solve(problem, k, settings, warmstart, &mut results));
        std::mem::swap(lane.clock(), clock);
        done
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
    /// Forces along the 2 (dim − 1) edges of pyramid `block` of the problem last solved, in the order y₀ + μ₁y₁,
    /// y₀ − μ₁y₁, y₀ + μ₂y₂, ...; empty for other costs.
    pub fn edge_forces(&self, problem: &Problem<T>, block: usize) -> &[T] {
        let b = &problem.jacobian.blocks[block];
        if b.cost == Cost::Pyramid {
            &self.edges[b.pieces()]
        } else {
            &[]
        }
    }
    /// Where the time of solves goes once it runs, by [`SolvePart`].
    pub fn clock(&mut self) -> &mut SolveClock {
        &mut self.whole.course.clock
    }
    /// Statistics of the last solve.
    pub fn stats(&self) -> &SolveStats<T> {
        &self.stats
    }
}

fn copy<T: Copy>(to: &mut Vec<T>, from: &[T]) {
    to.clear();
    to.extend_from_slice(from);
}
