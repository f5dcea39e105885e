//! The iterate: the state that changes during a solve.

use crate::block_index::BlockIndex;
use crate::continuation::Continuation;
use crate::costs::{BlockCost, Rows, Totals, with_cost};
use crate::jacobian::Jacobian;
use crate::normal_forces::NormalForces;
use crate::problem::Problem;
use crate::ray::Ray;
use clench_math::{Mask, Real, Scalar, kernel};

/// A point, and the quantities derived from it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Iterate<T: Real> {
    /// a.
    pub qacc: Vec<T>,
    /// M (a − a_unc).
    pub inertial: Vec<T>,
    /// y = J a − aref.
    pub residual: Vec<T>,
    /// f = −∇s(y).
    pub force: Vec<T>,
    /// Jᵀ f.
    pub qfrc_constraint: Vec<T>,
    /// g = M (a − a_unc) − Jᵀ f.
    pub gradient: Vec<T>,
    /// The piece of its cost that each row or edge is on.
    pub active_set: Vec<T>,
    pub continuation: Continuation<T>,
    pub normal_forces: NormalForces<T>,
}

impl<T: Real> Iterate<T> {
    /// Starts from `warmstart` if it costs less than the unconstrained acceleration; returns the totals there.
    #[kernel]
    pub fn start(
        &mut self,
        problem: &Problem<T>,
        warmstart: Option<&[T]>,
        ray: &mut Ray<T>,
    ) -> Totals<T> {
        match warmstart {
            Some(warm) => {
                self.move_to(problem, &problem.qacc_smooth);
                self.better_of(problem, warm, ray)
            }
            None => self.start_at(problem, &problem.qacc_smooth),
        }
    }

    /// Moves to an acceleration, as if it were the unconstrained one; returns the totals of the constraints there.
    #[kernel]
    pub fn start_at(&mut self, problem: &Problem<T>, qacc: &[T]) -> Totals<T> {
        self.move_to(problem, qacc);
        self.normal_forces.start(problem, &self.residual);
        self.evaluate(problem)
    }

    /// Moves to an acceleration, as if it were the unconstrained one, and computes the residual there.
    #[kernel]
    fn move_to(&mut self, problem: &Problem<T>, qacc: &[T]) {
        let (nv, nrow) = (problem.nv(), problem.nrow());
        self.continuation.reset();
        for v in [
            &mut self.inertial,
            &mut self.gradient,
            &mut self.qfrc_constraint,
        ] {
            v.clear();
            v.resize(nv, T::ZERO);
        }
        self.residual.resize(nrow, T::ZERO);
        self.force.resize(nrow, T::ZERO);
        self.active_set.resize(problem.nactive, T::ZERO);
        self.qacc.clear();
        self.qacc.extend_from_slice(qacc);
        problem.jacobian.mul(&self.qacc, &mut self.residual);
        subtract(&mut self.residual, &problem.aref);
    }

    /// Evaluates everything at `qacc`, gradient included.
    #[kernel]
    pub fn evaluate_at_qacc(&mut self, problem: &Problem<T>) {
        let qacc = std::mem::take(&mut self.qacc);
        self.start_at(problem, &qacc);
        let displacement = &mut self.gradient;
        displacement.copy_from_slice(&qacc);
        subtract(displacement, &problem.qacc_smooth);
        (problem.mass).mul(problem.tree(), displacement, &mut self.inertial);
        self.differentiate(problem);
    }

    /// Moves to `warm` in the lanes in which it costs less than the current point. Returns the totals.
    #[kernel]
    fn better_of(&mut self, problem: &Problem<T>, warm: &[T], ray: &mut Ray<T>) -> Totals<T> {
        // The ray from the current point to `warm`.
        ray.direction.clear();
        ray.direction.extend_from_slice(warm);
        subtract(&mut ray.direction, &self.qacc);
        ray.mass_direction.resize(problem.nv(), T::ZERO);
        problem
            .mass
            .mul(problem.tree(), &ray.direction, &mut ray.mass_direction);
        ray.rows.resize(problem.nrow(), T::ZERO);
        problem.jacobian.mul(warm, &mut ray.rows);
        subtract(&mut ray.rows, &problem.aref);
        // Costs can be compared if friction has the same limits: those of `warm`, which is near the solution.
        self.normal_forces.start(problem, &ray.rows);
        let totals = self.evaluate(problem);
        self.residual.swap_with_slice(&mut ray.rows);
        let warm_totals = self.evaluate(problem);
        let inertial = T::new(0.5) * dot(&ray.direction, &ray.mass_direction);
        let better = (warm_totals.cost + inertial).lt(totals.cost);
        blend(better, &mut self.qacc, warm);
        blend(better, &mut self.inertial, &ray.mass_direction);
        if better.all() {
            return warm_totals;
        }
        blend(!better, &mut self.residual, &ray.rows);
        self.evaluate(problem)
    }

    /// Recomputes M (a − a_unc) and J a − aref in the lanes of `mask`, without the accumulated rounding of the steps.
    /// The gradient is overwritten.
    #[kernel]
    pub fn refresh(&mut self, problem: &Problem<T>, mask: T::Mask, ray: &mut Ray<T>) {
        // Not stored in the ray's direction, which conjugate gradients still need in the other lanes.
        let displacement = &mut self.gradient;
        displacement.copy_from_slice(&self.qacc);
        subtract(displacement, &problem.qacc_smooth);
        problem
            .mass
            .mul(problem.tree(), displacement, &mut ray.mass_direction);
        problem.jacobian.mul(&self.qacc, &mut ray.rows);
        subtract(&mut ray.rows, &problem.aref);
        blend(mask, &mut self.inertial, &ray.mass_direction);
        blend(mask, &mut self.residual, &ray.rows);
    }

    /// Returns the cost parameters of a block for the current stage of continuation and the limiting normal forces λ.
    #[inline(always)]
    pub(crate) fn rows<'a>(&self, problem: &'a Problem<T>, b: &BlockIndex) -> Rows<'a, T> {
        Rows {
            softer: self.continuation.of(b),
            lambda: self.normal_forces.of(b),
            ..problem.rows(b)
        }
    }

    /// Evaluates every block at the residual: forces, the active set, and the cost of the constraints.
    #[kernel]
    pub fn evaluate(&mut self, problem: &Problem<T>) -> Totals<T> {
        let mut totals = Totals::new();
        for b in &problem.jacobian.blocks {
            let rows = b.rows();
            with_cost!(b.cost, C => {
                let active_set = b.active_start..b.active_start + <C as BlockCost<T>>::active_len(b.dim);
                C::evaluate(
                    self.rows(problem, b),
                    &self.residual[rows.clone()],
                    &mut self.force[rows],
                    &mut self.active_set[active_set],
                    &mut totals,
                );
            });
        }
        totals
    }

    /// Computes Jᵀf and the gradient; returns its norm.
    #[kernel]
    pub fn differentiate(&mut self, problem: &Problem<T>) -> T {
        self.qfrc_constraint.fill(T::ZERO);
        problem
            .jacobian
            .add_transposed(&self.force, &mut self.qfrc_constraint);
        let mut square = T::ZERO;
        for ((g, &m), &q) in self
            .gradient
            .iter_mut()
            .zip(&self.inertial)
            .zip(&self.qfrc_constraint)
        {
            *g = m - q;
            square += *g * *g;
        }
        square.sqrt()
    }

    /// Computes the norm of the rounding errors of the gradient, in which opposing forces cancel.
    #[kernel]
    pub fn rounding(&self, problem: &Problem<T>, sizes: &mut Vec<T>) -> T {
        sizes.clear();
        sizes.extend_from_slice(&self.inertial);
        for x in sizes.iter_mut() {
            *x = x.abs();
        }
        problem.jacobian.add_transposed_sizes(&self.force, sizes);
        T::splat(T::Scalar::EPSILON) * dot(sizes, sizes).sqrt()
    }

    /// Returns the lanes in which the acceleration and the residuals are finite. (The one-sided cost of NaN is zero, so
    /// costs do not show it.)
    #[inline(always)]
    pub(crate) fn is_finite(&self) -> T::Mask {
        all_finite(&self.qacc) & all_finite(&self.residual)
    }

    /// Computes ½ (a − a_unc)ᵀ M (a − a_unc).
    #[inline(always)]
    pub(crate) fn inertial_cost(&self, problem: &Problem<T>) -> T {
        let mut sum = T::ZERO;
        for ((&a, &b), &m) in self
            .qacc
            .iter()
            .zip(&problem.qacc_smooth)
            .zip(&self.inertial)
        {
            sum += (a - b) * m;
        }
        T::new(0.5) * sum
    }
}

/// Returns the lanes in which all of `x` is finite.
#[inline(always)]
pub(crate) fn all_finite<T: Real>(x: &[T]) -> T::Mask {
    let mut finite = T::Mask::splat(true);
    for x in x {
        finite &= x.is_finite();
    }
    finite
}

/// Computes x·y.
#[inline(always)]
pub(crate) fn dot<T: Real>(x: &[T], y: &[T]) -> T {
    let mut sum = T::ZERO;
    for (&x, &y) in x.iter().zip(y) {
        sum += x * y;
    }
    sum
}

#[inline(always)]
pub(crate) fn add_scaled<T: Real>(x: &mut [T], alpha: T, y: &[T]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x += alpha * y;
    }
}

#[inline(always)]
fn subtract<T: Real>(x: &mut [T], y: &[T]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x -= y;
    }
}

#[inline(always)]
fn blend<T: Real>(mask: T::Mask, x: &mut [T], y: &[T]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x = T::select(mask, y, *x);
    }
}
