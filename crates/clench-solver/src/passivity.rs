//! Solves by CG that end at their limit of iterations are passive.
//!
//! The constraints change the velocity from w₀ = v + h a_unc to w = v + h a, as if by the force F = M (a − a_unc) = Jᵀf
//! + g. The gradient g is zero only at the minimum. Elsewhere it could do work, as if there were a motor:
//!
//! ```text
//! ½ wᵀM w − ½ w₀ᵀM w₀ = h wᵀF − ½ h² FᵀM⁻¹F ≤ h wᵀJᵀf + h wᵀg
//! ```
//!
//! So a last line search scales w: it moves the iterate along w / h. At its minimum wᵀg = 0, and only the forces f do
//! work. Each of them opposes its row as at the end of any other solve, f·y ≤ 0, because a cost is convex and least at
//! y = 0. For friction that holds with every limit λ. Before the search λ becomes the normal force, since an early λ
//! can be many times as large.

use crate::iterate::{Iterate, dot};
use crate::line_search::Precision;
use crate::problem::Problem;
use crate::ray::Ray;
use crate::stats::{SolveStats, Status};
use clench_math::{Mask, Real, kernel};

/// Scales the velocity at the end of the step so that the cost is least, in the lanes that ended at their limit.
/// `scale` is that of gradients.
#[kernel]
pub(crate) fn scale_velocity<T: Real>(
    problem: &Problem<T>,
    precision: Precision<T>,
    (iterate, ray, stats): (&mut Iterate<T>, &mut Ray<T>, &mut SolveStats<T>),
    scale: T,
) {
    let mask = stats.status.eq(Status::IterationLimit.code());
    if problem.rest.is_empty() || !mask.any() {
        return;
    }
    (iterate.normal_forces).replace(problem, &iterate.force, mask);
    iterate.evaluate(problem);
    iterate.differentiate(problem);
    ray.direction.clear();
    (ray.direction).extend(iterate.qacc.iter().zip(&problem.rest).map(
        #[inline(always)]
        |(&a, &rest)| T::select(mask, a - rest, T::ZERO),
    ));
    let rises = dot(&ray.direction, &iterate.gradient).gt(T::ZERO);
    for p in &mut ray.direction {
        *p = T::select(rises, -*p, *p);
    }
    ray.prepare(problem);
    let step = ray.search(problem, iterate, false, precision, mask);
    ray.advance(step.alpha, iterate);
    iterate.evaluate(problem);
    let norm = iterate.differentiate(problem);
    stats.gradient = T::select(mask, scale * norm, stats.gradient);
}
