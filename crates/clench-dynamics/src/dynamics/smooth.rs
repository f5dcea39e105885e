//! The sum of all forces except constraints, and the resulting acceleration.

use crate::dynamics::integrate::add_scaled;
use crate::dynamics::project::{force_at, project_forces};
use crate::model::Model;
use crate::part::Part;
use crate::stages::{Forces, Positions};
use crate::state::State;
use clench_math::{Force, Mask, Real, kernel};
use clench_solver::{Problem, Tree, solve_differentiated};

/// Computes `qfrc_smooth` of some parts: passive + actuator + applied − bias.
#[kernel]
pub(crate) fn smooth_forces<T: Real>(
    model: &Model,
    parts: &[Part],
    state: &State<T>,
    pos: &Positions<T>,
    force: &mut Forces<T>,
) {
    for part in parts {
        for i in part.dofs.clone() {
            force.qfrc_smooth[i] = force.qfrc_passive[i] - force.qfrc_bias[i]
                + state.qfrc_applied[i]
                + force.qfrc_actuator[i];
        }
    }
    let is_zero = |f: &Force<T>| f.to_array().iter().all(|x| x.eq(T::ZERO).all());
    if state.xfrc_applied.iter().all(is_zero) {
        return;
    }
    for (b, applied) in state.xfrc_applied.iter().enumerate() {
        force.cfrc_body[b] = force_at(model, pos, b, pos.xipos[b], applied.linear, applied.angular);
    }
    let Forces {
        cfrc_body,
        qfrc_smooth,
        ..
    } = force;
    project_forces(model, parts, pos, cfrc_body, qfrc_smooth);
}

/// Computes `qacc_smooth`, the acceleration of smooth forces and of the metric's −h K v (empty without a metric), by
/// the factor of the problem, in some parts, of which `tree` has the rows.
#[kernel]
pub(crate) fn smooth_acceleration<T: Real>(
    (parts, tree): (&[Part], &Tree),
    (qfrc_smooth, shift): (&[T], &[T]),
    problem: &mut Problem<T>,
    constant_factor: bool,
) {
    let qacc = &mut problem.qacc_smooth;
    for part in parts {
        qacc[part.dofs.clone()].copy_from_slice(&qfrc_smooth[part.dofs.clone()]);
    }
    add_scaled(qacc, shift, T::ONE);
    if T::IS_DUAL && constant_factor {
        solve_differentiated(tree, &problem.mass, qacc);
        return;
    }
    problem.mass_factor.solve(tree, qacc);
}
