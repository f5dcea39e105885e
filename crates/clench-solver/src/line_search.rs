//! The exact line search.
//!
//! Along a ray the cost is convex, piecewise quadratic but for elliptic cones, and its derivatives are analytic. So its
//! minimiser is the root of an increasing function, found by Newton's method kept inside a bracket, across as many piece
//! changes as lie on the way. J p and M p are computed once for the ray; an evaluation touches rows only.

use crate::costs::{BlockCost, Slope, with_cost};
use crate::iterate::{Iterate, add_scaled, dot};
use crate::jacobian::Jacobian;
use crate::ray::Ray;
use crate::{Cost, Problem};
use clench_math::{Mask, Real, Scalar, kernel};

/// Where a line search ended.
#[derive(Clone, Copy)]
pub(crate) struct Step<T: Real> {
    /// Step length; 0 where no step reduces the cost.
    pub alpha: T,
    /// Reduction of the cost, ≥ 0.
    pub improvement: T,
    /// Evaluations of the derivatives.
    pub evaluations: T,
    /// Lanes in which the evaluations ran out before the search had closed in on a point.
    pub cut: T::Mask,
}

/// How precisely a ray is searched.
#[derive(Clone, Copy)]
pub(crate) struct Precision<T> {
    /// Most evaluations.
    pub evaluations: usize,
    /// The slope counts as zero below this times the length of p.
    pub slope: T,
}

/// How precisely a root is worth finding whatever the tolerance, over the square root of the working precision: a slope
/// relative to the slope at 0, or a step relative to α. The next iteration corrects what is left.
const RESOLUTION: f64 = 0.01;
/// What a tolerance may accept at most (Wolfe's conditions; Nocedal & Wright 2006, §3.1): a slope of this part of the slope
/// at 0, and a decrease of at least this part of what the slope at 0 promises.
const CURVATURE: f64 = 0.1;
const DECREASE: f64 = 1e-4;
/// The rounding error of a slope, over the working precision, relative to the inertial part of it.
const NOISE: f64 = 4.0;

impl<T: Real> Ray<T> {
    /// Computes M p, J p and the quadratic part, for the direction already set.
    #[kernel]
    pub fn prepare(&mut self, problem: &Problem<T>, iterate: &Iterate<T>) {
        self.mass_direction.resize(problem.nv(), T::ZERO);
        self.rows.resize(problem.nrow(), T::ZERO);
        problem
            .mass
            .mul(problem.tree(), &self.direction, &mut self.mass_direction);
        problem.jacobian.mul(&self.direction, &mut self.rows);
        let mut slope = Slope {
            first: dot(&iterate.inertial, &self.direction),
            second: dot(&self.direction, &self.mass_direction),
        };
        for b in problem
            .jacobian
            .blocks
            .iter()
            .filter(|b| b.cost == Cost::Quadratic)
        {
            let (y, dy) = (&iterate.residual[b.rows()], &self.rows[b.rows()]);
            crate::costs::Quadratic::slope(problem.rows(b), y, dy, T::ZERO, &mut slope);
        }
        (self.first, self.second) = (slope.first, slope.second);
    }

    /// Moves the iterate by `alpha` along the ray.
    #[kernel]
    pub fn advance(&self, alpha: T, iterate: &mut Iterate<T>) {
        add_scaled(&mut iterate.qacc, alpha, &self.direction);
        add_scaled(&mut iterate.inertial, alpha, &self.mass_direction);
        add_scaled(&mut iterate.residual, alpha, &self.rows);
    }

    /// Derivatives of the cost at α.
    #[kernel]
    fn slope(&self, problem: &Problem<T>, iterate: &Iterate<T>, alpha: T) -> Slope<T> {
        let mut slope = Slope {
            first: self.first + alpha * self.second,
            second: self.second,
        };
        for b in problem
            .jacobian
            .blocks
            .iter()
            .filter(|b| b.cost != Cost::Quadratic)
        {
            let (y, dy) = (&iterate.residual[b.rows()], &self.rows[b.rows()]);
            with_cost!(b.cost, C => C::slope(iterate.rows(problem, b), y, dy, alpha, &mut slope));
        }
        slope
    }

    /// Cost at α less cost at 0.
    #[kernel]
    fn change(&self, problem: &Problem<T>, iterate: &Iterate<T>, alpha: T) -> T {
        let inertial = dot(&iterate.inertial, &self.direction);
        let mass = dot(&self.direction, &self.mass_direction);
        let mut sum = alpha * (inertial + T::new(0.5) * alpha * mass);
        for b in &problem.jacobian.blocks {
            let (y, dy) = (&iterate.residual[b.rows()], &self.rows[b.rows()]);
            sum += with_cost!(b.cost, C => C::change(iterate.rows(problem, b), y, dy, alpha));
        }
        sum
    }

    /// Finds the minimiser along the ray in the lanes of `live`. `newton` says that the direction is Newton's, so that 1 is
    /// the first guess; otherwise the guess comes from the derivatives at 0.
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
            cut: descends,
        };
        if !descends.any() || precision.evaluations == 0 {
            return step;
        }
        let count = |mask| T::select(mask, T::ONE, T::ZERO);
        let mut guess = T::ONE;
        if !newton {
            guess = -start / self.slope(problem, iterate, T::ZERO).second;
            step.evaluations += count(descends);
        }
        let epsilon = T::splat(T::Scalar::EPSILON);
        let resolution = T::new(RESOLUTION) * epsilon.sqrt();
        let length = dot(&self.direction, &self.direction).sqrt();
        // The slope is a difference of two that nearly cancel: below their rounding it means nothing.
        let noise = T::new(NOISE) * epsilon * self.first.abs();
        let exact = noise.max(-(resolution * start));
        let loose = (precision.slope * length).min(-(T::new(CURVATURE) * start));
        let mut bracket = Bracket::new(guess);
        let mut open = descends;
        for _ in 0..precision.evaluations {
            let slope = self.slope(problem, iterate, bracket.alpha);
            step.evaluations += count(open);
            let steepness = slope.first.abs();
            open &= steepness.gt(exact);
            // However loose the tolerance, the cost has to fall: beyond a kink the slope can be small where it has risen.
            let near = open & steepness.le(loose);
            if near.any() {
                let change = self.change(problem, iterate, bracket.alpha);
                let enough = T::new(DECREASE) * bracket.alpha * start;
                open &= !(near & change.le(enough));
            }
            open &= bracket.narrow(slope, resolution, open);
            if !open.any() {
                break;
            }
        }
        step.cut = open & (bracket.high - bracket.low).gt(resolution);
        step.alpha = T::select(descends, bracket.alpha, T::ZERO);
        let mut change = self.change(problem, iterate, step.alpha);
        // Only a search cut short can end above its start (elsewhere, what looks like it is rounding); the low end of its
        // bracket does not.
        let worse = open & change.gt(T::ZERO);
        if worse.any() {
            step.alpha = T::select(worse, bracket.low, step.alpha);
            change = T::select(worse, self.change(problem, iterate, step.alpha), change);
        }
        // A convex function falls by no more than its slope at 0 promises; beyond that, the difference is rounding.
        step.improvement = (-change).min(-(step.alpha * start)).max(T::ZERO);
        step
    }
}

/// The interval that holds the root, and the point to evaluate next.
struct Bracket<T> {
    low: T,
    high: T,
    alpha: T,
    /// Length of the step before the last, to see whether Newton's method makes headway.
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

    /// Takes in the slope at `alpha` and moves `alpha`, in the lanes of `open`; returns those where it moved noticeably.
    #[inline(always)]
    fn narrow(&mut self, slope: Slope<T>, resolution: T, open: T::Mask) -> T::Mask {
        let falling = slope.first.lt(T::ZERO);
        self.low = T::select(open & falling, self.alpha, self.low);
        self.high = T::select(open & !falling, self.alpha, self.high);
        let newton = self.alpha - slope.first / slope.second;
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
