//! The status and statistics of a solve.

use crate::transfer::Transfer;
use clench_math::{Real, Scalar};

/// The status of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// No constraint acts; the result is the unconstrained acceleration.
    #[default]
    Unconstrained,
    /// The duality gap proved the starting point good enough before any iteration.
    Proven,
    /// Newton: the gradient and the last improvement are below the tolerance, or a full step within one quadratic piece
    /// ended there. CG: the duality gap is below the tolerance.
    Converged,
    /// The working precision allows no further progress. With a tolerance of zero this counts as success.
    NoProgress,
    /// The solve reached its iteration limit, or a line search reached its own before it found a lower cost.
    IterationLimit,
    /// A number became infinite or NaN; the result of this lane is not usable.
    NonFinite,
    /// The problem was not solved because it needs larger matrices than the settings allow.
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

    /// Returns the name used in output, such as "no_progress".
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

/// The statistics of a solve, one value per lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct SolveStats<T> {
    /// The number of iterations; over islands, the maximum.
    pub iterations: T,
    /// The gradient norm over mean inertia × nv; over islands, the maximum.
    pub gradient: T,
    /// The last cost improvement over mean inertia × nv; over islands, the maximum.
    pub improvement: T,
    /// The duality gap ½ gᵀM⁻¹g: an upper bound of cost − minimum, in the units of the cost.
    pub gap: T,
    /// The largest difference between the normal force of a Coulomb contact and the one that limits its friction, N;
    /// zero where Coulomb's law holds; over islands, the maximum.
    pub normal_residual: T,
    /// The number of changes of a constraint's piece in all iterations.
    pub active_set_changes: T,
    /// The number of line-search evaluations.
    pub ls_evaluations: T,
    /// The number of Hessians factored from scratch.
    pub factorizations: T,
    /// The number of rank-one updates of a factored Hessian.
    pub updates: T,
    /// The number of noslip sweeps; over islands, the maximum.
    pub noslip_iterations: T,
    /// The number of separately solved parts; 1 if constraints act but islands are not used.
    pub islands: T,
    pub(crate) status: T,
}

/// The [`SolveStats`] of one lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneStats {
    /// The status of the solve; over islands, the worst.
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
    pub normal_residual: f64,
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
    /// Adds the statistics of another island in the lanes that have it.
    #[inline(always)]
    pub(crate) fn combine<F: Real>(
        &mut self,
        other: &SolveStats<F>,
        lanes: T::Mask,
        transfer: impl Transfer<T, F>,
    ) {
        // Status codes ascend from good to bad.
        for (worst, other) in [
            (&mut self.iterations, other.iterations),
            (&mut self.gradient, other.gradient),
            (&mut self.improvement, other.improvement),
            (&mut self.normal_residual, other.normal_residual),
            (&mut self.noslip_iterations, other.noslip_iterations),
            (&mut self.status, other.status),
        ] {
            *worst = T::select(lanes, worst.max(transfer.convert_back(other)), *worst);
        }
        for (sum, other) in [
            (&mut self.gap, other.gap),
            (&mut self.active_set_changes, other.active_set_changes),
            (&mut self.ls_evaluations, other.ls_evaluations),
            (&mut self.factorizations, other.factorizations),
            (&mut self.updates, other.updates),
            (&mut self.islands, other.islands),
        ] {
            *sum = T::select(lanes, *sum + transfer.convert_back(other), *sum);
        }
    }

    /// Returns the status of lane `lane`.
    pub fn status(&self, lane: usize) -> Status {
        Status::ALL[self.status.lane(lane).to_f64() as usize]
    }

    /// Returns the lanes that ended with [`Status::NonFinite`] or [`Status::TooLarge`].
    #[inline(always)]
    pub fn failed(&self) -> T::Mask {
        self.status.ge(Status::NonFinite.code())
    }

    /// Returns the statistics of lane `lane`.
    pub fn lane(&self, lane: usize) -> LaneStats {
        let count = |x: T| x.lane(lane).to_f64() as usize;
        let value = |x: T| x.lane(lane).to_f64();
        LaneStats {
            status: self.status(lane),
            iterations: count(self.iterations),
            gradient: value(self.gradient),
            improvement: value(self.improvement),
            gap: value(self.gap),
            normal_residual: value(self.normal_residual),
            active_set_changes: count(self.active_set_changes),
            ls_evaluations: count(self.ls_evaluations),
            factorizations: count(self.factorizations),
            updates: count(self.updates),
            noslip_iterations: count(self.noslip_iterations),
            islands: count(self.islands),
        }
    }
}
