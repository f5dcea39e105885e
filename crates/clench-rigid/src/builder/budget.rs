//! What a model would take, held against its budget before it is taken.

use super::element::Element;
use super::{BuildError, ModelBuilder};
use crate::budget::RAISE;
use crate::model::Model;

/// The matrices of a model whose dofs are known.
///
/// # Errors
/// A mass matrix, or moment arms of actuators, of more numbers than the budget has.
pub(super) fn matrices(builder: &ModelBuilder, model: &Model) -> Result<(), BuildError> {
    let mut depths: Vec<u64> = Vec::with_capacity(model.nv);
    for dof in &model.dofs {
        depths.push(1 + dof.parent.map_or(0, |parent| depths[parent]));
    }
    let moments = (builder.actuators.len() as u64).saturating_mul(model.nv as u64);
    let most = builder.budget.matrix;
    for (what, count) in [
        ("mass matrix", depths.iter().sum()),
        (
            "matrix of moment arms, of each actuator about each dof,",
            moments,
        ),
    ] {
        if count > most {
            return Err(BuildError::new(
                "model",
                format!("its {what} would have {count} numbers, more than {most}; {RAISE}"),
            ));
        }
    }
    Ok(())
}

/// The keyframes of a model, each of which is a state.
///
/// # Errors
/// More memory for them than the budget has.
pub(super) fn keyframes(builder: &ModelBuilder, model: &Model) -> Result<(), BuildError> {
    let numbers = model.nq + model.nv + model.na + model.nu() + 7 * model.nmocap;
    let bytes = (builder.keyframes.len() as u64).saturating_mul(8 * numbers as u64);
    let most = builder.budget.bytes;
    match builder.keyframes.last() {
        Some(last) if bytes > most => Err(last.error(format!(
            "{} keyframes would take {bytes} bytes, more than {most}; {RAISE}",
            builder.keyframes.len()
        ))),
        _ => Ok(()),
    }
}
