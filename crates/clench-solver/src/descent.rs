//! The iteration loop of Newton and CG: direction, exact line search, step, and the stopping conditions.

use crate::costs::Totals;
use crate::iterate::{Iterate, dot};
use crate::line_search::{Precision, Step};
use crate::options::Settings;
use crate::passivity::scale_velocity;
use crate::problem::Problem;
use crate::ray::Ray;
use crate::stats::{SolveStats, Status};
use crate::stopwatch::{SolveClock, SolvePart};
use crate::threads::Threads;
use clench_math::{Mask, Real, Scalar, kernel};

/// A method that computes search directions.
pub(crate) trait Direction<T: Real> {
    /// True if a full step is the minimiser of the current quadratic piece.
    const NEWTON: bool;
    /// The number of iterations without noticeable progress that ends a solve.
    const PATIENCE: f64;
    /// Prepares for the iterations of a solve. Returns false if that needs larger matrices than the settings allow.
    fn prepare(&mut self, problem: &Problem<T>, settings: &Settings) -> bool;
    /// Discards the stored state in the lanes of `mask`, whose iterate or problem was changed.
    fn restart(&mut self, mask: T::Mask);
    /// Computes the duality gap at the iterate, for a method that stops by it.
    fn gap(&mut self, problem: &Problem<T>, iterate: &Iterate<T>) -> T;
    /// Writes the next direction into `state.ray`, which holds the last one.
    fn find(
        &mut self,
        problem: &Problem<T>,
        convergence: &Convergence<T>,
        state: &mut SolverState<T>,
    );
}

/// The state of a descent: iterate, search direction and statistics.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolverState<T: Real> {
    pub iterate: Iterate<T>,
    pub ray: Ray<T>,
    pub stats: SolveStats<T>,
    pub clock: SolveClock,
    /// The threads that share the work on a large Hessian.
    pub threads: Threads,
}

/// The convergence state of each lane.
pub(crate) struct Convergence<T: Real> {
    /// The lanes that are still iterating.
    pub live: T::Mask,
    /// The lanes whose Hessian is that of the last iteration: no piece changed, none is curved.
    pub same_hessian: T::Mask,
    /// The lanes in which some block is on a curved piece.
    pub curved: T::Mask,
    /// The smallest gradient norm so far, and the number of iterations since it decreased noticeably.
    best: T,
    idle: T,
    /// The lanes that were refreshed when they first seemed stuck.
    refreshed: T::Mask,
    /// 1 / (mean inertia × nv), the scale of gradients and improvements.
    scale: T,
    tolerance: T,
    /// CG: the duality gap, times `scale`, when friction was last limited by its own normal forces; zero without any.
    outer_gap: T,
}

/// An improvement below this many times the rounding error of the cost is negligible.
pub(crate) const NEGLIGIBLE: f64 = 4.0;
/// A gradient counts as progress if it is below this fraction of the best so far.
pub(crate) const NOTICEABLE: f64 = 0.7;
/// CG solves for fixed limits of friction until the duality gap is this fraction of the one that new limits left.
const INNER: f64 = 0.1;

/// Minimises the cost, starting from the better of `warmstart` and the unconstrained acceleration.
#[kernel]
pub(crate) fn minimise<T: Real, D: Direction<T>>(
    problem: &Problem<T>,
    settings: &Settings,
    warmstart: Option<&[T]>,
    direction: &mut D,
    state: &mut SolverState<T>,
) {
    state.clock.start();
    let inertia = trace(problem);
    let tolerance = T::new(settings.tolerance);
    let precision = Precision {
        evaluations: settings.ls_iterations,
        slope: tolerance * T::new(settings.ls_tolerance) * inertia,
    };
    let SolverState { iterate, ray, .. } = &mut *state;
    let totals = iterate.start(problem, warmstart, ray);
    let mut convergence = Convergence::new(totals, T::ONE / inertia, tolerance);
    convergence.judge_start(problem, direction, state);
    if !direction.prepare(problem, settings) {
        let all = T::Mask::splat(true);
        convergence.end(all, Status::TooLarge, &mut state.stats);
    }
    let iterate = &mut state.iterate;
    if D::NEWTON && iterate.continuation.start(problem, convergence.live).any() {
        convergence.curved = iterate.evaluate(problem).curved;
        iterate.differentiate(problem);
    }
    state.clock.lap(SolvePart::Start as usize);
    for _ in 0..settings.iterations {
        if !convergence.live.any() {
            break;
        }
        direction.find(problem, &convergence, state);
        let SolverState {
            iterate,
            ray,
            clock,
            ..
        } = &mut *state;
        for p in &mut ray.direction {
            *p = T::select(convergence.live, *p, T::ZERO);
        }
        clock.lap(SolvePart::Direction as usize);
        ray.prepare(problem);
        let step = ray.search(problem, iterate, D::NEWTON, precision, convergence.live);
        clock.lap(SolvePart::LineSearch as usize);
        ray.advance(step.alpha, iterate);
        let totals = iterate.evaluate(problem);
        let norm = iterate.differentiate(problem);
        convergence.record(step, totals, norm, &mut state.stats);
        convergence.judge(problem, direction, state, step, totals, norm);
        state.clock.lap(SolvePart::Evaluation as usize);
    }
    if !D::NEWTON {
        let state = (&mut state.iterate, &mut state.ray, &mut state.stats);
        scale_velocity(problem, precision, state, convergence.scale);
    }
    convergence.finish(problem, state);
    state.clock.lap(SolvePart::Evaluation as usize);
}

impl<T: Real> Convergence<T> {
    #[inline(always)]
    fn new(totals: Totals<T>, scale: T, tolerance: T) -> Self {
        Convergence {
            live: T::Mask::splat(true),
            same_hessian: T::Mask::splat(false),
            curved: totals.curved,
            best: T::splat(T::Scalar::INFINITY),
            idle: T::ZERO,
            refreshed: T::Mask::splat(false),
            scale,
            tolerance,
            outer_gap: T::ZERO,
        }
    }

    /// Ends the live lanes of `mask` with `status`.
    #[inline(always)]
    fn end(&mut self, mask: T::Mask, status: Status, stats: &mut SolveStats<T>) {
        let ending = self.live & mask;
        stats.status = T::select(ending, status.code(), stats.status);
        self.live &= !mask;
    }

    /// Ends the lanes that need no iteration.
    #[inline(always)]
    fn judge_start<D: Direction<T>>(
        &mut self,
        problem: &Problem<T>,
        direction: &mut D,
        state: &mut SolverState<T>,
    ) {
        let SolverState {
            iterate,
            ray,
            stats,
            ..
        } = state;
        let norm = iterate.differentiate(problem);
        stats.gradient = self.scale * norm;
        stats.status = Status::IterationLimit.code();
        self.end(
            !(iterate.is_finite() & norm.is_finite()),
            Status::NonFinite,
            stats,
        );
        self.end(!constrained(problem), Status::Unconstrained, stats);
        // Newton must also give accurate forces; a small gap bounds only the cost, so stiff forces could be wrong.
        let mut proven = self.live;
        if D::NEWTON {
            proven &= stats.gradient.le(self.tolerance);
        }
        if proven.any() {
            let gap = self.scale * gap(problem, iterate, &mut ray.direction);
            if !D::NEWTON {
                self.outer_gap = iterate.normal_forces.if_pressed(gap);
            }
            let proven = proven & gap.le(self.tolerance);
            let proven = self.consistent(problem, direction, (iterate, ray, stats), proven);
            self.end(proven, Status::Proven, stats);
        }
    }

    /// Adds a step to the statistics.
    #[inline(always)]
    fn record(&self, step: Step<T>, totals: Totals<T>, norm: T, stats: &mut SolveStats<T>) {
        let live = self.live;
        stats.iterations += T::select(live, T::ONE, T::ZERO);
        stats.ls_evaluations += step.evaluations;
        stats.active_set_changes += T::select(live, totals.changes, T::ZERO);
        stats.gradient = T::select(live, self.scale * norm, stats.gradient);
        stats.improvement = T::select(live, self.scale * step.improvement, stats.improvement);
    }

    /// Ends the lanes that are done, and prepares the others for their next iteration.
    #[inline(always)]
    fn judge<D: Direction<T>>(
        &mut self,
        problem: &Problem<T>,
        direction: &mut D,
        state: &mut SolverState<T>,
        step: Step<T>,
        totals: Totals<T>,
        norm: T,
    ) {
        let SolverState {
            iterate,
            ray,
            stats,
            ..
        } = state;
        self.end(!norm.is_finite(), Status::NonFinite, stats);
        self.same_hessian = totals.changes.eq(T::ZERO) & !totals.curved & !self.curved;
        self.curved = totals.curved;
        let cost = totals.cost + iterate.inertial_cost(problem);

        let in_continuation = iterate.continuation.active();
        if in_continuation.any() {
            let moved = self.live & iterate.continuation.advance(step.improvement, cost);
            self.reevaluate(problem, iterate, moved);
            direction.restart(moved);
        }

        // A full Newton step within one quadratic piece ends at its minimum, so the size of that step carries no
        // information.
        let exact = self.same_hessian & T::Mask::splat(D::NEWTON);
        let converged = if D::NEWTON {
            let settled = stats.improvement.le(self.tolerance) | exact;
            stats.gradient.le(self.tolerance) & settled & !in_continuation
        } else {
            let gap = self.scale * direction.gap(problem, iterate);
            gap.le(self.tolerance.max(T::new(INNER) * self.outer_gap))
        };
        let converged = self.consistent(problem, direction, (iterate, ray, stats), converged);
        self.end(converged, Status::Converged, stats);
        // At this minimum, a gradient that rounding of its terms explains is zero to working precision.
        let minimum = self.live & exact & !in_continuation;
        if minimum.any() {
            let rounding = iterate.rounding(problem, &mut ray.mass_direction);
            let minimum = minimum & norm.le(rounding);
            let minimum = self.consistent(problem, direction, (iterate, ray, stats), minimum);
            self.end(minimum, Status::NoProgress, stats);
        }

        let rounding = T::splat(T::Scalar::EPSILON) * T::new(NEGLIGIBLE) * cost;
        let negligible = step.improvement.le(rounding) | exact;
        let idle = self.idles(norm, negligible, T::new(D::PATIENCE));
        let stuck = self.live & !in_continuation & (step.alpha.eq(T::ZERO) | idle);
        // Stopping is not due to the precision if the search was not allowed to reach a lower cost.
        let truncated = stuck & step.truncated & step.alpha.eq(T::ZERO);
        self.end(truncated & self.refreshed, Status::IterationLimit, stats);
        let refreshed = stuck & self.refreshed;
        let done = self.consistent(problem, direction, (iterate, ray, stats), refreshed);
        self.end(done, Status::NoProgress, stats);
        let again = stuck & self.live;
        if again.any() {
            // Retry once without the accumulated rounding of the steps.
            iterate.refresh(problem, again, ray);
            self.reevaluate(problem, iterate, again);
            self.refreshed |= again;
            direction.restart(again);
        }
    }

    /// Returns the lanes of `mask` that live and whose friction is limited by their own normal forces: all without
    /// Coulomb contacts. The others continue with new limits.
    #[kernel]
    fn consistent<D: Direction<T>>(
        &mut self,
        problem: &Problem<T>,
        direction: &mut D,
        (iterate, ray, stats): (&mut Iterate<T>, &mut Ray<T>, &mut SolveStats<T>),
        mask: T::Mask,
    ) -> T::Mask {
        let mask = mask & self.live;
        if !(iterate.normal_forces.exist() && mask.any()) {
            return mask;
        }
        let (gamma, moved) = iterate.normal_forces.replace(problem, &iterate.force, mask);
        // The gradient changes only with the limits, and these have no effect where all contacts stick.
        let settled = stats.gradient.le(self.tolerance) & T::Mask::splat(D::NEWTON);
        if !(mask & !settled | moved).any() {
            return mask;
        }
        let totals = iterate.evaluate(problem);
        let acts = moved & (!totals.changes.eq(T::ZERO) | totals.curved | self.curved);
        if !(mask & !settled | acts).any() {
            return mask;
        }
        let norm = self.differentiate(problem, iterate, totals, mask);
        stats.gradient = T::select(mask, self.scale * norm, stats.gradient);
        let mut consistent = stats.gradient.le(self.tolerance);
        if (mask & !consistent).any() {
            consistent |= norm.le(iterate.rounding(problem, &mut ray.mass_direction));
        }
        if !D::NEWTON {
            let gap = self.scale * gap(problem, iterate, &mut ray.mass_direction);
            consistent |= gap.le(self.tolerance);
            self.outer_gap = T::select(mask, gap, self.outer_gap);
        }
        let others = mask & !consistent;
        if others.any() {
            iterate.normal_forces.mix(problem, gamma, others);
            let norm = self.reevaluate(problem, iterate, others);
            stats.gradient = T::select(others, self.scale * norm, stats.gradient);
            self.refreshed &= !others;
            // Conjugate directions stay conjugate where new limits have no effect.
            direction.restart(others & (acts | T::Mask::splat(D::NEWTON)));
        }
        mask & consistent
    }

    /// Returns true if the gradient has not decreased noticeably for too many iterations of negligible improvement.
    #[inline(always)]
    fn idles(&mut self, norm: T, negligible: T::Mask, patience: T) -> T::Mask {
        let fell = norm.lt(T::new(NOTICEABLE) * self.best);
        self.best = T::select(fell, norm, self.best);
        self.idle = T::select(fell | !negligible, T::ZERO, self.idle + T::ONE);
        self.idle.ge(patience)
    }

    /// Reevaluates after the lanes of `mask` were changed by more than a step; returns the norm of the gradient.
    #[inline(always)]
    fn reevaluate(&mut self, problem: &Problem<T>, iterate: &mut Iterate<T>, mask: T::Mask) -> T {
        let totals = iterate.evaluate(problem);
        self.differentiate(problem, iterate, totals, mask)
    }

    /// Completes the evaluation that returned `totals`; returns the norm of the gradient.
    #[kernel]
    fn differentiate(
        &mut self,
        problem: &Problem<T>,
        iterate: &mut Iterate<T>,
        totals: Totals<T>,
        mask: T::Mask,
    ) -> T {
        let norm = iterate.differentiate(problem);
        self.curved = totals.curved;
        self.same_hessian &= !mask;
        self.best = T::select(mask, norm, self.best);
        self.idle = T::select(mask, T::ZERO, self.idle);
        norm
    }

    /// Completes the statistics.
    #[kernel]
    fn finish(&mut self, problem: &Problem<T>, state: &mut SolverState<T>) {
        let SolverState {
            iterate,
            ray,
            stats,
            ..
        } = state;
        let in_continuation = iterate.continuation.active();
        if in_continuation.any() {
            // The iterations ended during continuation: report the values of the original problem.
            iterate.continuation.reset();
            iterate.evaluate(problem);
            let norm = iterate.differentiate(problem);
            stats.gradient = T::select(in_continuation, self.scale * norm, stats.gradient);
        }
        stats.gap = gap(problem, iterate, &mut ray.direction);
        stats.normal_residual = iterate.normal_forces.residual(problem, &iterate.force);
    }
}

/// Computes the duality gap ½ gᵀM⁻¹g. The cost minus ½ |a|²_M is convex, so the cost exceeds its minimum by at most
/// this.
#[kernel]
fn gap<T: Real>(problem: &Problem<T>, iterate: &Iterate<T>, scratch: &mut Vec<T>) -> T {
    scratch.clear();
    scratch.extend_from_slice(&iterate.gradient);
    problem.mass_factor.solve_half(problem.tree(), scratch);
    T::new(0.5) * dot(scratch, scratch)
}

/// Returns the lanes in which some constraint acts.
#[inline(always)]
fn constrained<T: Real>(problem: &Problem<T>) -> T::Mask {
    problem
        .d
        .iter()
        .fold(T::Mask::splat(false), |mask, d| mask | d.gt(T::ZERO))
}

/// Computes mean inertia × nv.
#[inline(always)]
pub(crate) fn trace<T: Real>(problem: &Problem<T>) -> T {
    let tree = problem.tree();
    let mut sum = T::ZERO;
    for i in 0..tree.nv() {
        sum += problem.mass.values[tree.row_start(i + 1) - 1];
    }
    sum
}
