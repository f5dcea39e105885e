//! Euler, implicit in the velocity derivatives of damping, fluid and actuation (MuJoCo's `implicitfast`).
//!
//! With D = ∂τ/∂v, the acceleration that advances the velocity solves (M − h D) a = τ + Jᵀf, see
//! [`derivatives`](crate::dynamics::derivatives) for D. A free body that is a tree by itself is then solved once more, with its
//! gyroscopic forces, see [`gyroscopic`](crate::dynamics::gyroscopic).

use crate::dynamics::derivatives::add_velocity_derivatives;
use crate::dynamics::gyroscopic::{is_free_tree, solve_gyroscopic};
use crate::dynamics::integrate::{Integration, advance_semi_implicit, solve_implicit};
use crate::model::{Model, Params};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Real, kernel};

/// Advances the state by a time step, from the accelerations and forces of `ws`.
#[kernel]
pub fn implicit_fast<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    let matrix = &mut ws.integration.matrix;
    matrix.values.copy_from_slice(&ws.problem.mass.values);
    add_velocity_derivatives(
        model,
        params,
        state,
        (&ws.position, &ws.velocity, &ws.force),
        -params.timestep,
        matrix,
    );
    let Integration { matrix, factor, .. } = &mut ws.integration;
    ws.singular |= !factor.factor(&model.tree, matrix);
    solve_implicit(&model.tree, ws);
    for j in 0..model.joints.len() {
        if is_free_tree(model, j) {
            solve_gyroscopic(model, params, j, &state.qvel, ws);
        }
    }
    advance_semi_implicit(model, params, state, ws);
}
