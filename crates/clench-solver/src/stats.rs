//! What a solve reports.

use clench_math::{Real, Scalar};

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// No constraint acts: the unconstrained acceleration is the answer.
    #[default]
    Unconstrained,
    /// The starting point was proven good enough, by the duality gap, before any iteration.
    Proven,
    /// Newton: gradient and last improvement are below the tolerance, or a full step over a purely quadratic stretch ended
    /// there. CG: the duality gap is below it.
    Converged,
    /// The working precision allows no further progress. With a tolerance of zero this is success.
    NoProgress,
    /// The iteration limit came first, or that of a line search before it found a lower cost.
    IterationLimit,
    /// A number became infinite or undefined; the result of this lane is not usable.
    NonFinite,
    /// The problem needs larger matrices than the settings allow; it was not solved.
    TooLarge,
}

impl Status {
    pub(crate) const ALL: [Status; 7] = [
        Status::Unconstrained,
        Status::Proven,
        Status::Converged,
        Status::NoProgress,
        Status::IterationLimit,
        Status::NonFinite,
        Status::TooLarge,
    ];

    /// Its name in output, such as "no_progress".
    pub fn name(self) -> &'static str {
        match self {
            Status::Unconstrained => "unconstrained",
            Status::Proven => "proven",
            Status::Converged => "converged",
            Status::NoProgress => "no_progress",
            Status::IterationLimit => "iteration_limit",
            Status::NonFinite => "non_finite",
            Status::TooLarge => "too_large",
        }
    }

    #[inline(always)]
    pub(crate) fn code<T: Real>(self) -> T {
        T::new(f64::from(self as u8))
    }
}

/// Statistics of a solve, one value a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct SolveStats<T> {
    /// Iterations; over islands, the most.
    pub iterations: T,
    /// Gradient norm over mean inertia × nv; over islands, the largest.
    pub gradient: T,
    /// Last cost improvement over mean inertia × nv; over islands, the largest.
    pub improvement: T,
    /// Duality gap ½ gᵀM⁻¹g: an upper bound of cost − minimum, in the units of the cost.
    pub gap: T,
    /// How often a constraint changed its piece, in all iterations.
    pub piece_changes: T,
    /// Line-search evaluations.
    pub ls_evaluations: T,
    /// Hessians factored from scratch.
    pub factorizations: T,
    /// Rank-one updates of a factored Hessian.
    pub updates: T,
    /// Sweeps of noslip.
    pub noslip_iterations: T,
    /// Separately solved parts; 1 where islands are not used and constraints act.
    pub islands: T,
    pub(crate) status: T,
}

/// [`SolveStats`] of one lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneStats {
    /// How the solve ended; over islands, the worst.
    pub status: Status,
    /// See [`SolveStats`].
    pub iterations: usize,
    /// See [`SolveStats`].
    pub gradient: f64,
    /// See [`SolveStats`].
    pub improvement: f64,
    /// See [`SolveStats`].
    pub gap: f64,
    /// See [`SolveStats`].
    pub piece_changes: usize,
    /// See [`SolveStats`].
    pub ls_evaluations: usize,
    /// See [`SolveStats`].
    pub factorizations: usize,
    /// See [`SolveStats`].
    pub updates: usize,
    /// See [`SolveStats`].
    pub noslip_iterations: usize,
    /// See [`SolveStats`].
    pub islands: usize,
}

impl<T: Real> SolveStats<T> {
    /// Takes in the statistics of another island.
    pub(crate) fn combine(&mut self, other: &SolveStats<T>) {
        self.iterations = self.iterations.max(other.iterations);
        self.gradient = self.gradient.max(other.gradient);
        self.improvement = self.improvement.max(other.improvement);
        self.gap += other.gap;
        self.piece_changes += other.piece_changes;
        self.ls_evaluations += other.ls_evaluations;
        self.factorizations += other.factorizations;
        self.updates += other.updates;
        self.noslip_iterations = self.noslip_iterations.max(other.noslip_iterations);
        self.islands += other.islands;
        // Codes ascend from good to bad.
        self.status = self.status.max(other.status);
    }

    /// Takes lane `lane` from the statistics of a problem solved alone.
    pub(crate) fn set_lane(&mut self, lane: usize, alone: &SolveStats<T::Scalar>) {
        self.iterations.set_lane(lane, alone.iterations);
        self.gradient.set_lane(lane, alone.gradient);
        self.improvement.set_lane(lane, alone.improvement);
        self.gap.set_lane(lane, alone.gap);
        self.piece_changes.set_lane(lane, alone.piece_changes);
        self.ls_evaluations.set_lane(lane, alone.ls_evaluations);
        self.factorizations.set_lane(lane, alone.factorizations);
        self.updates.set_lane(lane, alone.updates);
        self.noslip_iterations
            .set_lane(lane, alone.noslip_iterations);
        self.islands.set_lane(lane, alone.islands);
        self.status.set_lane(lane, alone.status);
    }

    /// How lane `lane` ended.
    pub fn status(&self, lane: usize) -> Status {
        Status::ALL[self.status.lane(lane).to_f64() as usize]
    }

    /// The lanes that ended as [`Status::NonFinite`] or [`Status::TooLarge`].
    #[inline(always)]
    pub fn failed(&self) -> T::Mask {
        self.status.ge(Status::NonFinite.code())
    }

    /// The statistics of lane `lane`.
    pub fn lane(&self, lane: usize) -> LaneStats {
        let count = |x: T| x.lane(lane).to_f64() as usize;
        let value = |x: T| x.lane(lane).to_f64();
        LaneStats {
            status: self.status(lane),
            iterations: count(self.iterations),
            gradient: value(self.gradient),
            improvement: value(self.improvement),
            gap: value(self.gap),
            piece_changes: count(self.piece_changes),
            ls_evaluations: count(self.ls_evaluations),
            factorizations: count(self.factorizations),
            updates: count(self.updates),
            noslip_iterations: count(self.noslip_iterations),
            islands: count(self.islands),
        }
    }
}
