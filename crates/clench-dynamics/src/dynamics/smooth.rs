//! The sum of all forces except constraints, and the resulting acceleration.

use crate::dynamics::project::{force_at, project_forces};
use crate::model::Model;
use crate::stages::{Forces, Positions};
use crate::state::State;
use clench_math::{Force, Mask, Real, kernel};
use clench_solver::{Problem, solve_differentiated};

/// Computes `qfrc_smooth`: passive + actuator + applied − bias.
#[kernel]
pub(crate) fn smooth_forces<T: Real>(
    model: &Model,
    state: &State<T>,
    pos: &Positions<T>,
    force: &mut Forces<T>,
) {
    for (i, smooth) in force.qfrc_smooth.iter_mut().enumerate() {
        *smooth = force.qfrc_passive[i] - force.qfrc_bias[i]
            + state.qfrc_applied[i]
            + force.qfrc_actuator[i];
    }
    let still = |f: &Force<T>| f.to_array().iter().all(|x| x.eq(T::ZERO).all());
    if state.xfrc_applied.iter().all(still) {
        return;
    }
    for (b, applied) in state.xfrc_applied.iter().enumerate() {
        force.cfrc_body[b] = force_at(model, pos, b, pos.xipos[b], applied.linear, applied.angular);
    }
    project_forces(model, pos, &mut force.cfrc_body, &mut force.qfrc_smooth);
}

/// Replaces the forces in `qacc_smooth` with their acceleration, by the factor of the problem.
pub(crate) fn smooth_acceleration<T: Real>(
    model: &Model,
    problem: &mut Problem<T>,
    constant_factor: bool,
) {
    let (tree, qacc) = (&model.tree, &mut problem.qacc_smooth);
    if T::IS_DUAL && constant_factor {
        solve_differentiated(tree, &problem.mass, qacc);
        return;
    }
    problem.mass_factor.solve(tree, qacc);
}
