//! Joint and tendon equality: makes one coordinate a quartic of another, or constant.
//!
//! ```text
//! r = (y − y₀) − P(x − x₀)      P(e) = c₀ + c₁ e + c₂ e² + c₃ e³ + c₄ e⁴      J = ∂y/∂q − P′(x − x₀) ∂x/∂q
//! ```
//!
//! The subscript 0 marks the initial configuration. As in MuJoCo, aref omits the part of r̈ that is quadratic in
//! velocity, −P″ ẋ². A₀ is the sum of both coordinates' inverse weights.

use super::assembly::Assembly;
use super::context::ConstraintContext;
use super::coordinate::Coordinate;
use super::row::Row;
use crate::model::Params;
use crate::stages::Positions;
use clench_math::{Real, kernel};
use clench_solver::Cost;

#[kernel]
pub(super) fn push<T: Real>(
    context: &ConstraintContext<T>,
    out: &mut Assembly<T>,
    equality: usize,
    follower: Coordinate,
    leader: Option<Coordinate>,
) {
    let polynomial = context.params.eq_polycoef[equality];
    let error = |c: Coordinate| c.value(context) - c.initial(context);
    let dofs = out.dofs();
    dofs.clear();
    follower.insert_dofs(context, dofs);
    let mut slope = T::ZERO;
    let mut target = polynomial[0];
    let mut a0 = follower.inverse_weight(context);
    if let Some(leader) = leader {
        leader.insert_dofs(context, dofs);
        (target, slope) = evaluate(polynomial, error(leader));
        a0 += leader.inverse_weight(context);
    }
    let violation = error(follower) - target;
    let (soft, block) = context.equality(equality, violation);
    let row = Row::new(&soft, violation, T::ZERO, a0);
    out.push(
        Cost::Quadratic,
        block,
        &[row],
        #[inline(always)]
        |dofs, jacobian| {
            follower.add_gradient(context, dofs, T::ONE, jacobian);
            if let Some(leader) = leader {
                leader.add_gradient(context, dofs, -slope, jacobian);
            }
        },
    );
}

/// Computes P′ of tendon equality `equality` at the leading tendon's length.
#[inline(always)]
pub fn equality_slope<T: Real>(
    params: &Params<T>,
    pos: &Positions<T>,
    equality: usize,
    leader: usize,
) -> T {
    let error = pos.ten_length[leader] - params.tendon_length0[leader];
    evaluate(params.eq_polycoef[equality], error).1
}

/// Computes P′ and P″ of an equality at the error `e` of its leader.
pub fn equality_rates(params: &Params<f64>, equality: usize, e: f64) -> [f64; 2] {
    let polynomial = params.eq_polycoef[equality];
    let [_, _, second, third, fourth] = polynomial;
    let curvature = 2.0 * second + e * (6.0 * third + e * (12.0 * fourth));
    [evaluate(polynomial, e).1, curvature]
}

/// Computes P(e) and P′(e).
#[inline(always)]
fn evaluate<T: Real>(polynomial: [T; 5], e: T) -> (T, T) {
    let (mut value, mut slope) = (polynomial[4], T::ZERO);
    for coefficient in polynomial[..4].iter().rev() {
        slope = slope * e + value;
        value = value * e + *coefficient;
    }
    (value, slope)
}
