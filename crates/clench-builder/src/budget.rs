//! Checks of a model's resources against its budget before allocation.

use super::BuildError;
use super::element::Element;
use super::model_builder::ModelBuilder;
use clench_dynamics::budget::RAISE;
use clench_dynamics::model::{Coupled, Model};

/// Checks the matrices of a model whose dofs are determined.
///
/// # Errors
/// Returns an error if the mass matrix or the moment arms of actuators or tendons exceed the budget.
pub(super) fn matrices(builder: &ModelBuilder, model: &Model) -> Result<(), BuildError> {
    let mut depths: Vec<u64> = Vec::with_capacity(model.nv);
    for dof in &model.dofs {
        depths.push(1 + dof.parent.map_or(0, |parent| depths[parent]));
    }
    let about_dofs = |count: usize| (count as u64).saturating_mul(model.nv as u64);
    check_budget(builder, "mass matrix", depths.iter().sum())?;
    let actuators = about_dofs(builder.actuators.len());
    check_budget(builder, "matrix of moment arms of actuators", actuators)?;
    let tendons = about_dofs(builder.tendons.len());
    check_budget(builder, "matrix of moment arms of tendons", tendons)
}

/// Checks the Jacobian of the equalities of a model.
///
/// # Errors
/// Returns an error if it exceeds the budget.
pub(super) fn equalities(builder: &ModelBuilder, model: &Model) -> Result<(), BuildError> {
    let path = |body: usize| {
        let last = model.bodies[body].last_dof;
        last.map_or(0, |dof| model.tree.row(dof).len() as u64)
    };
    let rows = model.equalities.iter().map(|equality| {
        let dofs = match equality.target.coupled() {
            Coupled::Points(bodies) | Coupled::Frames(bodies) => bodies.map(path).iter().sum(),
            Coupled::Joints(..) => 2,
            Coupled::Tendons(..) => 2 * model.nv as u64,
        };
        equality.target.rows() as u64 * dofs
    });
    check_budget(builder, "Jacobian of equalities", rows.sum())
}

fn check_budget(builder: &ModelBuilder, what: &str, count: u64) -> Result<(), BuildError> {
    let limit = builder.budget.matrix;
    match count > limit {
        true => Err(BuildError::new(
            "model",
            format!("its {what} would have {count} numbers, more than {limit}; {RAISE}"),
        )),
        false => Ok(()),
    }
}

/// Checks the keyframes of a model, each of which is a state.
///
/// # Errors
/// Returns an error if they exceed the budget.
pub(super) fn keyframes(builder: &ModelBuilder, model: &Model) -> Result<(), BuildError> {
    let numbers = model.nq + model.nv + model.na + model.nplastic + model.nu() + 7 * model.nmocap;
    let bytes = (builder.keyframes.len() as u64).saturating_mul(8 * numbers as u64);
    let limit = builder.budget.bytes;
    match builder.keyframes.last() {
        Some(last) if bytes > limit => Err(last.error(format!(
            "{} keyframes would take {bytes} bytes, more than {limit}; {RAISE}",
            builder.keyframes.len()
        ))),
        _ => Ok(()),
    }
}
