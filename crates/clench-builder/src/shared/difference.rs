//! The error for models that cannot share a layout.

use clench_dynamics::error::SimError;
use clench_dynamics::model::Model;
use std::sync::Arc;

/// Returns the error for models of which one differs from the first.
pub(super) fn differ(models: &[Arc<Model>], other: usize, difference: String) -> SimError {
    SimError::ModelsDiffer {
        first: models[0].name.clone(),
        number: other,
        other: models[other].name.clone(),
        difference,
    }
}
