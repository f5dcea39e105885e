//! Euler, implicit in velocity derivatives of damping, fluid and actuation (MuJoCo's `implicitfast`), and optionally of
//! Coriolis forces (its `implicit`).
//!
//! With D = ∂τ/∂v, the acceleration that advances the velocity solves (M − h D) a = τ + Jᵀf; for D see
//! [`derivatives`](crate::dynamics::derivatives). A free body that is its own tree is then solved once more with its
//! gyroscopic forces, see [`gyroscopic`](crate::dynamics::gyroscopic). With Coriolis forces, see
//! [`coriolis`](crate::dynamics::coriolis), D is not symmetric, and all bodies are solved by LU.

use super::integration::Integration;
use crate::dynamics::coriolis::add_bias_derivatives;
use crate::dynamics::derivatives::add_velocity_derivatives;
use crate::dynamics::ellipsoid::FluidForces;
use crate::dynamics::gyroscopic::{gyroscopic_product, is_free_tree, solve_gyroscopic};
use crate::dynamics::integrate::{
    add_scaled, advance_semi_implicit, factor_implicit, solve_implicit, sum_forces,
};
use crate::model::{Model, Params};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Real, array, kernel};

/// Advances the state by a time step, from the accelerations and forces of `ws`.
#[kernel]
pub fn implicit_fast<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    symmetric_inertia(model, params, state, ws);
    let positive = factor_implicit(model, ws);
    ws.singular |= !positive;
    solve_implicit(model, ws);
    let Workspace {
        position: pos,
        velocity: vel,
        force,
        qfrc_constraint,
        integration,
        ..
    } = &mut *ws;
    let total = |i: usize| force.qfrc_smooth[i] + qfrc_constraint[i];
    for (j, joint) in model.joints.iter().enumerate() {
        if is_free_tree(model, j) {
            let system = (&integration.matrix, array(|r| total(joint.dof + r)));
            let stages = (pos as &_, vel as &_);
            let fluid = FluidForces::All;
            let x = solve_gyroscopic(model, params, j, &state.qvel, stages, fluid, system);
            integration.qacc[joint.dof..joint.dof + 6].copy_from_slice(&x);
        }
    }
    advance_semi_implicit(model, params, state, ws);
}

/// Does the same with the derivatives of Coriolis forces.
#[kernel]
pub fn implicit<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    full_inertia(model, params, state, ws);
    sum_forces(ws);
    let Integration { full, qacc, .. } = &mut ws.integration;
    ws.singular |= !full.factor(&model.tree);
    full.solve(&model.tree, qacc);
    advance_semi_implicit(model, params, state, ws);
}

/// Computes M − h D with Coriolis forces into `integration.full`.
#[inline(always)]
pub(crate) fn full_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    symmetric_inertia(model, params, state, ws);
    let Integration {
        matrix,
        full,
        coriolis,
        ..
    } = &mut ws.integration;
    full.lower.copy_from_slice(&matrix.values);
    full.upper.copy_from_slice(&matrix.values);
    let (stages, h) = ((&ws.position, &ws.velocity), params.timestep);
    add_bias_derivatives(model, params, stages, &state.qvel, h, coriolis, full);
}

/// Computes M − h D without Coriolis forces into `integration.matrix`.
#[inline(always)]
pub(crate) fn symmetric_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
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
}

/// Adds the gyroscopic forces of free bodies to `integration.qacc`, the product of M − h D and `ws.qacc`.
#[kernel]
pub(crate) fn add_gyroscopic_products<T: Real>(
    model: &Model,
    params: &Params<T>,
    qvel: &[T],
    ws: &mut Workspace<T>,
) {
    let stages = (&ws.position, &ws.velocity);
    for (j, joint) in model.joints.iter().enumerate() {
        if is_free_tree(model, j) {
            let fluid = FluidForces::All;
            let product = gyroscopic_product(model, params, j, qvel, stages, fluid, &ws.qacc);
            add_scaled(&mut ws.integration.qacc[joint.dof..], &product, T::ONE);
        }
    }
}
