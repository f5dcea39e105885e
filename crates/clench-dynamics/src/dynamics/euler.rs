//! Semi-implicit Euler, implicit in joint damping.
//!
//! The damping force is evaluated at the end of the step to first order, with slope B: the acceleration that advances
//! the velocity solves (M + h B) a = τ + Jᵀf instead of M a = τ + Jᵀf. A model without damping needs no second
//! factorization.

use crate::dynamics::articulated::articulated_factor;
use crate::dynamics::integrate::{advance_semi_implicit, factor_implicit, solve_implicit};
use crate::dynamics::reflected::dof_damper;
use crate::model::{Model, Params};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, kernel};

/// Advances the state by a time step, from the accelerations and forces of `ws`.
#[kernel]
pub fn euler<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    ws.integration.qacc.copy_from_slice(&ws.qacc);
    let damped = damped_lanes(model, params, ws);
    if damped.any() {
        damped_acceleration(model, params, &state.qvel, damped, ws);
    }
    advance_semi_implicit(model, params, state, ws);
}

/// Returns the lanes with implicit damping and a damped dof, which change only with the parameters.
#[inline(always)]
pub(crate) fn damped_lanes<T: Real>(
    model: &Model,
    params: &Params<T>,
    ws: &mut Workspace<T>,
) -> T::Mask {
    let version = ws.fixed.version();
    if !T::IS_DUAL && version == ws.integration.damped.1 {
        return ws.integration.damped.0;
    }
    let mut damped = T::Mask::splat(false);
    if model.flags.eulerdamp && model.flags.damper {
        for i in 0..model.nv {
            let damper = dof_damper(model, params, i);
            damped |= damper.linear.gt(T::ZERO) | damper.is_curved();
        }
    }
    ws.integration.damped = (damped, version);
    damped
}

/// Computes M + h B into `integration.matrix`, for [`damped_acceleration`] and for inverse dynamics.
#[kernel]
pub(crate) fn damped_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    qvel: &[T],
    damped: T::Mask,
    ws: &mut Workspace<T>,
) {
    let matrix = &mut ws.integration.matrix;
    matrix.values.copy_from_slice(&ws.problem.mass.values);
    for (i, &v) in qvel.iter().enumerate() {
        if let Some(diagonal) = matrix.row_mut(&model.tree, i).last_mut() {
            let slope = dof_damper(model, params, i).damping_slope(v);
            *diagonal += T::select(damped, params.timestep * slope, T::ZERO);
        }
    }
}

/// Solves with M + h B in the `damped` lanes.
#[inline(always)]
fn damped_acceleration<T: Real>(
    model: &Model,
    params: &Params<T>,
    qvel: &[T],
    damped: T::Mask,
    ws: &mut Workspace<T>,
) {
    let positive = if T::IS_DUAL || ws.articulated.is_empty() {
        damped_inertia(model, params, qvel, damped, ws);
        factor_implicit(model, ws)
    } else {
        let factor = &mut ws.integration.factor;
        let (pos, bodies) = (&ws.position, &mut ws.articulated);
        articulated_factor(
            model,
            params,
            pos,
            #[inline(always)]
            |i| params.timestep * dof_damper(model, params, i).damping_slope(qvel[i]),
            bodies,
            factor,
        )
    };
    ws.singular |= damped & !positive;
    solve_implicit(model, ws);
    for (solved, &explicit) in ws.integration.qacc.iter_mut().zip(&ws.qacc) {
        *solved = T::select(damped, *solved, explicit);
    }
}
