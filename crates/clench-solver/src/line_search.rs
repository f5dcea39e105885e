//! The exact line search.
//!
//! Along a ray the cost is convex, piecewise quadratic except for elliptic cones, and its derivatives are analytic. So
//! its minimiser is the root of an increasing function. A bracketed Newton's method finds it, across any number of
//! piece changes along the ray. J p and M p are computed once per ray; an evaluation touches only rows.
//!
//! Opposing forces cancel in the slope, and would leave rounding errors if they are large. So the slope is computed as
//! the slope at the start, known from the gradient, plus the growth of each constraint's part. The cost is the tangent
//! at the start plus the rise of each part above its own tangent. Both are sums of terms of one sign, which do not
//! cancel.

use crate::block_index::BlockIndex;
use crate::costs::{BlockCost, Cost, Slope, with_cost};
use crate::iterate::{Iterate, add_scaled, dot};
use crate::jacobian::Jacobian;
use crate::problem::Problem;
use crate::ray::Ray;
use clench_math::{Mask, Real, Scalar, kernel};

/// The result of a line search.
#[derive(Clone, Copy)]
pub(crate) struct Step<T: Real> {
    /// The step length; 0 if no step reduces the cost.
    pub alpha: T,
    /// The reduction of the cost, ≥ 0.
    pub improvement: T,
    /// The number of evaluations of the derivatives.
    pub evaluations: T,
    /// The lanes in which the evaluations ran out before the search converged.
    pub truncated: T::Mask,
}

/// The precision of a line search.
#[derive(Clone, Copy)]
pub(crate) struct Precision<T> {
    /// The maximum number of evaluations. With 0 the search ends at its first guess, unless the cost is higher there.
    pub evaluations: usize,
    /// The slope counts as zero below this times the length of p.
    pub slope: T,
}

/// The precision to which a root is computed regardless of the tolerance, over the square root of the working
/// precision: a slope relative to the slope at 0, or a step relative to α. The next iteration corrects the remaining
/// error.
pub(crate) const RESOLUTION: f64 = 0.01;
/// The limits of what a tolerance may accept (Wolfe's conditions; Nocedal & Wright 2006, §3.1): a slope of at most this
/// fraction of the slope at 0, and a decrease of at least this fraction of the one that the slope at 0 predicts.
pub(crate) const CURVATURE: f64 = 0.1;
pub(crate) const DECREASE: f64 = 1e-4;

impl<T: Real> Ray<T> {
    /// Computes M p, J p and the second derivative of the parts that are quadratic everywhere, for the current
    /// direction.
    #[kernel]
    pub fn prepare(&mut self, problem: &Problem<T>) {
        self.mass_direction.resize(problem.nv(), T::ZERO);
        self.rows.resize(problem.nrow(), T::ZERO);
        problem
            .mass
            .mul(problem.tree(), &self.direction, &mut self.mass_direction);
        problem.jacobian.mul(&self.direction, &mut self.rows);
        self.second = dot(&self.direction, &self.mass_direction);
        let blocks = problem.jacobian.blocks.iter();
        for b in blocks.filter(|b| b.cost == Cost::Quadratic) {
            for (&d, &dy) in problem.rows(b).d.iter().zip(&self.rows[b.rows()]) {
                self.second += d * dy * dy;
            }
        }
    }

    /// Moves the iterate by `alpha` along the ray.
    #[kernel]
    pub fn advance(&self, alpha: T, iterate: &mut Iterate<T>) {
        add_scaled(&mut iterate.qacc, alpha, &self.direction);
        add_scaled(&mut iterate.inertial, alpha, &self.mass_direction);
        add_scaled(&mut iterate.residual, alpha, &self.rows);
    }

    /// Computes the increase of the slope from 0 to α, and the second derivative at α.
    #[kernel]
    fn slope(&self, problem: &Problem<T>, iterate: &Iterate<T>, alpha: T) -> Slope<T> {
        let mut slope = Slope {
            growth: alpha * self.second,
            second: self.second,
        };
        for b in piecewise(problem) {
            let (y, dy) = (&iterate.residual[b.rows()], &self.rows[b.rows()]);
            with_cost!(b.cost, C => C::slope(iterate.rows(problem, b), y, dy, alpha, &mut slope));
        }
        slope
    }

    /// Computes the cost at α minus the cost at 0, where its derivative is `start`.
    #[kernel]
    fn change(&self, problem: &Problem<T>, iterate: &Iterate<T>, start: T, alpha: T) -> T {
        let mut sum = T::new(0.5) * alpha * alpha * self.second;
        for b in piecewise(problem) {
            let (y, dy) = (&iterate.residual[b.rows()], &self.rows[b.rows()]);
            sum += with_cost!(b.cost, C => C::divergence(iterate.rows(problem, b), y, dy, alpha));
        }
        alpha * start + sum
    }

    /// Computes the minimiser along the ray in the lanes of `live`. If `newton` is true, the direction is Newton's and
    /// the first guess is 1; otherwise the guess comes from the derivatives at 0.
    #[kernel]
    pub fn search(
        &self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        newton: bool,
        precision: Precision<T>,
        live: T::Mask,
    ) -> Step<T> {
        let start = dot(&iterate.gradient, &self.direction);
        // False for NaN as well.
        let descends = live & start.lt(T::ZERO);
        let mut step = Step {
            alpha: T::ZERO,
            improvement: T::ZERO,
            evaluations: T::ZERO,
            truncated: descends,
        };
        if !descends.any() {
            return step;
        }
        let count = |mask| T::select(mask, T::ONE, T::ZERO);
        let mut guess = T::ONE;
        if !newton {
            guess = -start / self.slope(problem, iterate, T::ZERO).second;
            step.evaluations += count(descends);
        }
        let resolution = T::new(RESOLUTION) * T::splat(T::Scalar::EPSILON).sqrt();
        let length = dot(&self.direction, &self.direction).sqrt();
        let exact = -(resolution * start);
        let loose = (precision.slope * length).min(-(T::new(CURVATURE) * start));
        let mut bracket = Bracket::new(guess);
        let mut open = descends;
        for _ in 0..precision.evaluations {
            let Slope { growth, second } = self.slope(problem, iterate, bracket.alpha);
            let first = start + growth;
            step.evaluations += count(open);
            let steepness = first.abs();
            open &= steepness.gt(exact);
            // The cost must decrease, however loose the tolerance: beyond a kink the slope can be small although the
            // cost has risen.
            let near = open & steepness.le(loose);
            if near.any() {
                let change = self.change(problem, iterate, start, bracket.alpha);
                let enough = T::new(DECREASE) * bracket.alpha * start;
                open &= !(near & change.le(enough));
            }
            open &= bracket.narrow((first, second), resolution, open);
            if !open.any() {
                break;
            }
        }
        step.truncated = open & (bracket.high - bracket.low).gt(resolution);
        step.alpha = T::select(descends, bracket.alpha, T::ZERO);
        let mut reached = self.change(problem, iterate, start, step.alpha);
        // Only a truncated search can end above its start (elsewhere an apparent rise is rounding); the low end of its
        // bracket does not.
        let worse = open & reached.gt(T::ZERO);
        if worse.any() {
            step.alpha = T::select(worse, bracket.low, step.alpha);
            reached = T::select(
                worse,
                self.change(problem, iterate, start, step.alpha),
                reached,
            );
        }
        step.improvement = (-reached).max(T::ZERO);
        step
    }
}

/// Returns the blocks whose Hessian is not constant.
#[inline(always)]
fn piecewise<T: Real>(problem: &Problem<T>) -> impl Iterator<Item = &BlockIndex> {
    let blocks = problem.jacobian.blocks.iter();
    blocks.filter(|b| b.cost != Cost::Quadratic)
}

/// The interval that contains the root, and the next point to evaluate.
struct Bracket<T> {
    low: T,
    high: T,
    alpha: T,
    /// The length of the step before the last, to check the progress of Newton's method.
    step: T,
    last_step: T,
}

impl<T: Real> Bracket<T> {
    #[inline(always)]
    fn new(guess: T) -> Self {
        let infinity = T::splat(T::Scalar::INFINITY);
        Bracket {
            low: T::ZERO,
            high: infinity,
            alpha: guess,
            step: infinity,
            last_step: infinity,
        }
    }

    /// Updates the bracket with the slope at `alpha` and moves `alpha`, in the lanes of `open`. Returns the lanes in
    /// which it moved noticeably.
    #[inline(always)]
    fn narrow(&mut self, (first, second): (T, T), resolution: T, open: T::Mask) -> T::Mask {
        let falling = first.lt(T::ZERO);
        self.low = T::select(open & falling, self.alpha, self.low);
        self.high = T::select(open & !falling, self.alpha, self.high);
        let newton = self.alpha - first / second;
        let bounded = self.high.is_finite();
        let inside = newton.gt(self.low) & newton.lt(self.high);
        let headway = (newton - self.alpha).abs().lt(T::new(0.5) * self.last_step);
        let middle = T::new(0.5) * (self.low + self.high);
        let next = T::select(bounded & !(inside & headway), middle, newton);
        let step = (next - self.alpha).abs();
        let moved = open & step.gt(resolution * next.abs()) & next.is_finite();
        self.last_step = T::select(open, self.step, self.last_step);
        self.step = T::select(open, step, self.step);
        self.alpha = T::select(moved, next, self.alpha);
        moved
    }
}
