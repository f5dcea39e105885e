//! D = ∂τ/∂v: the velocity derivatives of smooth forces, in the pattern of the mass matrix.
//!
//! D omits Coriolis forces, so that it is symmetric, and couplings of dofs of different branches, so that M − h D
//! factors without fill (both as in MuJoCo's `implicitfast`). A force s along a generalized velocity J v contributes
//! its slope: s′ JᵀJ.

use super::actuator_derivatives::velocity_derivative;
use crate::dynamics::ellipsoid::{FluidForces, ellipsoid_rates};
use crate::dynamics::fluid::{Drag, fluid_acts, symmetric_and_skew};
use crate::dynamics::reflected::{dof_damper, tendon_damper};
use crate::dynamics::tendon;
use crate::dynamics::transmission::moment;
use crate::model::{Model, Params};
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Force, Mask, Motion, Real, kernel};
use clench_solver::TreeMatrix;

/// Computes `matrix += scale · D`.
#[kernel]
pub fn add_velocity_derivatives<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if model.flags.actuation {
        for u in 0..model.actuators.len() {
            let slope = velocity_derivative(model, params, state, (pos, vel, force), u);
            for output in model.actuators[u].outputs.clone() {
                add_outer(model, moment(model, pos, output), slope * scale, matrix);
            }
        }
    }
    add_fluid_derivatives(model, params, (pos, vel), FluidForces::All, scale, matrix);
    if model.flags.damper {
        for (i, &v) in state.qvel.iter().enumerate() {
            if let Some(diagonal) = matrix.row_mut(&model.tree, i).last_mut() {
                *diagonal -= dof_damper(model, params, i).damping_slope(v) * scale;
            }
        }
        for (t, &velocity) in vel.ten_velocity.iter().enumerate() {
            let damping = tendon_damper(model, params, t).damping_slope(velocity);
            let row = tendon::gradient(model, pos, t);
            add_outer(model, row, -damping * scale, matrix);
        }
    }
}

/// The entries of a body's part of the matrix.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    All,
    Diagonal,
}

/// Adds the part of fluid forces, or only drag, in D times `scale`. As in MuJoCo, drag alone of a body with a diagonal
/// mass matrix is diagonal too.
#[kernel]
pub(crate) fn add_fluid_derivatives<T: Real>(
    model: &Model,
    params: &Params<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    forces: FluidForces,
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if fluid_acts(model, params) {
        for b in 1..model.nbody() {
            let alone = model.bodies[b].diagonal_inertia && forces == FluidForces::Drag;
            let part = if alone { Part::Diagonal } else { Part::All };
            add_fluid(model, params, (pos, vel), b, (forces, part), scale, matrix);
        }
    }
}

/// Adds `scale · JᵀJ` of a sparse row J, restricted to the pattern.
#[inline(always)]
pub(crate) fn add_outer<T: Real>(
    model: &Model,
    row: impl Iterator<Item = (usize, T)> + Clone,
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if scale.eq(T::ZERO).all() {
        return;
    }
    for (i, arm) in row.clone() {
        let entries = matrix.row_mut(&model.tree, i);
        for (j, other) in row.clone() {
            if let Ok(k) = model.tree.row(i).binary_search(&(j as u32)) {
                entries[k] += scale * arm * other;
            }
        }
    }
}

/// Adds the drag on body `b`: entry (i, j) is the power, along dof j, of the change of the drag with dof i. Ellipsoid
/// forces contribute only their symmetric part.
#[inline(always)]
fn add_fluid<T: Real>(
    model: &Model,
    params: &Params<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    b: usize,
    (forces, part): (FluidForces, Part),
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if model.bodies[b].fluid_ellipsoids {
        let rates = ellipsoid_rates(model, params, (pos, vel), b, forces);
        let [rates, _] = symmetric_and_skew(rates);
        add_along_chain(
            model,
            pos,
            b,
            (part, scale),
            matrix,
            #[inline(always)]
            |axis| {
                let mut sum = Force::ZERO;
                for (x, rate) in axis.to_array().into_iter().zip(rates) {
                    sum += rate * x;
                }
                sum
            },
        );
    } else {
        let drag = Drag::new(model, params, pos, vel, b);
        add_along_chain(
            model,
            pos,
            b,
            (part, scale),
            matrix,
            #[inline(always)]
            |axis| drag.derivative(model, pos, axis),
        );
    }
}

/// Adds the change of a force on body `b` with its velocity; `change` returns that of each dof.
#[inline(always)]
fn add_along_chain<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    b: usize,
    (part, scale): (Part, T),
    matrix: &mut TreeMatrix<T>,
    change: impl Fn(Motion<T>) -> Force<T>,
) {
    let mut chain = model.bodies[b].last_dof;
    while let Some(i) = chain {
        let force = change(pos.cdof[i]);
        let entries = matrix.row_mut(&model.tree, i);
        let skipped = match part {
            Part::All => 0,
            Part::Diagonal => entries.len() - 1,
        };
        let entries = entries.iter_mut().zip(model.tree.row(i));
        for (entry, &j) in entries.skip(skipped) {
            *entry += scale * pos.cdof[j as usize].dot(force);
        }
        chain = model.dofs[i].parent;
    }
}
