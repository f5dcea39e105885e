//! What a solve reports.

use crate::transfer::Transfer;
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
    pub active_set_changes: T,
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
    pub active_set_changes: usize,
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
    /// Takes in the statistics of another island in the lanes that have it.
    #[inline(always)]
    pub(crate) fn combine<F: Real>(
        &mut self,
        other: &SolveStats<F>,
        lanes: T::Mask,
        transfer: impl Transfer<T, F>,
    ) {
        // Codes of the status ascend from good to bad.
        for (worst, other) in [
            (&mut self.iterations, other.iterations),
            (&mut self.gradient, other.gradient),
            (&mut self.improvement, other.improvement),
            (&mut self.noslip_iterations, other.noslip_iterations),
            (&mut self.status, other.status),
        ] {
            *worst = T::select(lanes, worst.max(transfer.put(other)), *worst);
        }
        for (sum, other) in [
            (&mut self.gap, other.gap),
            (&mut self.active_set_changes, other.active_set_changes),
            (&mut self.ls_evaluations, other.ls_evaluations),
            (&mut self.factorizations, other.factorizations),
            (&mut self.updates, other.updates),
            (&mut self.islands, other.islands),
        ] {
            *sum = T::select(lanes, *sum + transfer.put(other), *sum);
        }
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
            active_set_changes: count(self.active_set_changes),
            ls_evaluations: count(self.ls_evaluations),
            factorizations: count(self.factorizations),
            updates: count(self.updates),
            noslip_iterations: count(self.noslip_iterations),
            islands: count(self.islands),
        }
    }
}
