//! The loop that Newton and CG share: direction, exact line search, step, and the stopping conditions.

use crate::iterate::{Iterate, dot};
use crate::line_search::{Precision, Ray};
use crate::{Problem, Settings, SolveStats, Status};
use clench_math::{Mask, Real, Scalar};

/// How an algorithm chooses where to search.
pub(crate) trait Direction<T: Real> {
    /// Whether a full step is the minimiser of the current quadratic piece.
    const NEWTON: bool;
    /// How many iterations without noticeable progress are too many.
    const PATIENCE: f64;
    /// Called once before the iterations of a solve.
    fn prepare(&mut self, problem: &Problem<T>, settings: &Settings);
    /// Forgets what it has learned in the lanes of `mask`, whose iterate was moved.
    fn restart(&mut self, mask: T::Mask);
    /// Writes the next direction; `direction` holds the last one.
    fn find(
        &mut self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        progress: &Progress<T>,
        direction: &mut Vec<T>,
        stats: &mut SolveStats<T>,
    );
}

/// Where each lane stands.
pub(crate) struct Progress<T: Real> {
    /// Lanes still iterating.
    pub live: T::Mask,
    /// Lanes whose Hessian is that of the last iteration: no piece changed, none is curved.
    pub same_hessian: T::Mask,
    /// Lanes in which some block is on a curved piece.
    pub curved: T::Mask,
    /// Smallest gradient norm so far, and iterations since it fell noticeably.
    best: T,
    idle: T,
    /// Lanes that were refreshed when they first seemed stuck.
    refreshed: T::Mask,
}

/// An improvement below this many times the rounding error of the cost tells nothing.
const NEGLIGIBLE: f64 = 4.0;

/// A gradient has to fall to this part of the best so far to count as progress.
const NOTICEABLE: f64 = 0.7;

/// Minimises from where `iterate` stands; its statistics go to `stats`.
pub(crate) fn minimise<T: Real, D: Direction<T>>(
    problem: &Problem<T>,
    settings: &Settings,
    warmstart: Option<&[T]>,
    iterate: &mut Iterate<T>,
    ray: &mut Ray<T>,
    direction: &mut D,
    stats: &mut SolveStats<T>,
) {
    let tally = iterate.start(problem, warmstart, ray);
    let norm = iterate.differentiate(problem);
    let inertia = trace(problem);
    let scale = T::ONE / inertia;
    let tolerance = T::new(settings.tolerance);
    let precision = Precision {
        evaluations: settings.ls_iterations,
        slope: tolerance * T::new(settings.ls_tolerance) * inertia,
    };
    let mut progress = Progress {
        live: T::Mask::splat(true),
        same_hessian: T::Mask::splat(false),
        curved: tally.curved,
        best: norm,
        idle: T::ZERO,
        refreshed: T::Mask::splat(false),
    };
    stats.gradient = scale * norm;
    stats.status = Status::IterationLimit.code();
    let finite = iterate.is_finite() & norm.is_finite();
    progress.end(!finite, Status::NonFinite, stats);
    progress.end(!constrained(problem), Status::Unconstrained, stats);

    // Newton is trusted for its forces as well: the gap alone, a bound in cost, would let stiff ones be wrong.
    let gap = gap(problem, iterate, &mut ray.direction);
    let proven = (scale * gap).le(tolerance)
        & if D::NEWTON {
            stats.gradient.le(tolerance)
        } else {
            finite
        };
    progress.end(proven, Status::Proven, stats);

    direction.prepare(problem, settings);
    for _ in 0..settings.iterations {
        if !progress.live.any() {
            break;
        }
        direction.find(problem, iterate, &progress, &mut ray.direction, stats);
        for p in &mut ray.direction {
            *p = T::select(progress.live, *p, T::ZERO);
        }
        ray.prepare(problem, iterate);
        let step = ray.search(problem, iterate, D::NEWTON, precision, progress.live);
        iterate.advance(step.alpha, ray);
        let tally = iterate.evaluate(problem);
        let norm = iterate.differentiate(problem);

        let live = progress.live;
        let count = T::select(live, T::ONE, T::ZERO);
        stats.iterations += count;
        stats.ls_evaluations += step.evaluations;
        stats.piece_changes += T::select(live, tally.changes, T::ZERO);
        stats.gradient = T::select(live, scale * norm, stats.gradient);
        stats.improvement = T::select(live, scale * step.improvement, stats.improvement);

        progress.end(!norm.is_finite(), Status::NonFinite, stats);
        progress.same_hessian = tally.changes.eq(T::ZERO) & !tally.curved & !progress.curved;
        progress.curved = tally.curved;
        // A full Newton step over a quadratic stretch ends at the minimum: the size of that step says nothing more.
        let exact = if D::NEWTON {
            progress.same_hessian
        } else {
            T::Mask::splat(false)
        };
        let settled = stats.improvement.le(tolerance) | exact;
        progress.end(
            stats.gradient.le(tolerance) & settled,
            Status::Converged,
            stats,
        );
        let cost = tally.cost + iterate.inertial_cost(problem);
        let negligible = step
            .improvement
            .le(T::splat(T::Scalar::EPSILON) * T::new(NEGLIGIBLE) * cost)
            | exact;
        let stuck = progress.live
            & (step.alpha.eq(T::ZERO) | progress.idles(norm, negligible, T::new(D::PATIENCE)));
        progress.end(stuck & progress.refreshed, Status::NoProgress, stats);
        if (stuck & progress.live).any() {
            progress.refresh(problem, iterate, ray, stuck);
            direction.restart(stuck);
        }
    }
    stats.gap = self::gap(problem, iterate, &mut ray.direction);
}

impl<T: Real> Progress<T> {
    /// Ends the live lanes of `mask` with `status`.
    fn end(&mut self, mask: T::Mask, status: Status, stats: &mut SolveStats<T>) {
        let ending = self.live & mask;
        stats.status = T::select(ending, status.code(), stats.status);
        self.live &= !mask;
    }

    /// Gives the lanes of `stuck` a second chance from freshly computed residuals, if it is their first time.
    fn refresh(
        &mut self,
        problem: &Problem<T>,
        iterate: &mut Iterate<T>,
        ray: &mut Ray<T>,
        stuck: T::Mask,
    ) {
        iterate.refresh(problem, self.live & stuck, ray);
        let tally = iterate.evaluate(problem);
        let norm = iterate.differentiate(problem);
        self.refreshed |= stuck;
        self.same_hessian &= !stuck | (tally.changes.eq(T::ZERO) & !tally.curved);
        self.curved = tally.curved;
        self.best = T::select(stuck, norm, self.best);
        self.idle = T::select(stuck, T::ZERO, self.idle);
    }

    /// Whether the gradient has not fallen noticeably for too many iterations of negligible improvement.
    fn idles(&mut self, norm: T, negligible: T::Mask, patience: T) -> T::Mask {
        let fell = norm.lt(T::new(NOTICEABLE) * self.best);
        self.best = T::select(fell, norm, self.best);
        self.idle = T::select(fell | !negligible, T::ZERO, self.idle + T::ONE);
        self.idle.ge(patience)
    }
}

/// The duality gap ½ gᵀM⁻¹g. The cost less ½ |a|²_M is convex, so the cost exceeds its minimum by at most this.
fn gap<T: Real>(problem: &Problem<T>, iterate: &Iterate<T>, scratch: &mut Vec<T>) -> T {
    scratch.clear();
    scratch.extend_from_slice(&iterate.gradient);
    problem.mass_factor.solve_half(problem.tree(), scratch);
    T::new(0.5) * dot(scratch, scratch)
}

/// The lanes in which some constraint acts.
fn constrained<T: Real>(problem: &Problem<T>) -> T::Mask {
    problem
        .d
        .iter()
        .fold(T::Mask::splat(false), |mask, d| mask | d.gt(T::ZERO))
}

/// Mean inertia × nv.
pub(crate) fn trace<T: Real>(problem: &Problem<T>) -> T {
    let tree = problem.tree();
    let mut sum = T::ZERO;
    for i in 0..tree.nv() {
        sum += problem.mass.values[tree.row_start(i + 1) - 1];
    }
    sum
}
