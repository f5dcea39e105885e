//! Buffers of past values, which delay the values of actuators and sensors.

use super::BuildError;
use super::element::Element;
use super::elements::HistorySpec;
use super::model_builder::ModelBuilder;
use clench_dynamics::budget::RAISE;
use clench_dynamics::model::{History, Model};

/// Allocates the past values of an element, `width` numbers per sample, if it stores any.
///
/// # Errors
/// Returns an error for a negative delay, a delay without samples, or samples that are empty or exceed the budget.
pub(super) fn add(
    builder: &ModelBuilder,
    element: &impl Element,
    spec: HistorySpec,
    width: usize,
    model: &mut Model,
) -> Result<Option<History>, BuildError> {
    element.require_not_negative("delay", &[spec.delay])?;
    if spec.delay > 0.0 && spec.nsample == 0 {
        return Err(element.error("a delay needs stored past values (nsample)"));
    }
    if spec.nsample == 0 {
        return Ok(None);
    }
    if width == 0 {
        return Err(element.error("nsample needs values to store, but this element has none"));
    }
    let limit = builder.budget.matrix;
    let numbers = (spec.nsample as u64).saturating_mul(width as u64 + 1);
    if numbers.saturating_add(model.nhistory as u64) > limit {
        return Err(element.error(format!(
            "with it the model stores more than {limit} past values; {RAISE}"
        )));
    }
    let history = History {
        start: model.nhistory,
        samples: spec.nsample,
        width,
        interpolation: spec.interp,
    };
    model.nhistory += history.size();
    Ok(Some(history))
}
