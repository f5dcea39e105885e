//! Replacement of `derivatives` in a package that is built without them.

use crate::batch::Batch;
use crate::error::classes::ClenchError;
use crate::linearize::Linearization;
use crate::sim::Sim;
use pyo3::prelude::*;

/// The memory of a simulation's derivatives: none.
pub(crate) type Memory = ();

/// Returns an error that says how to build a package with derivatives.
pub(crate) fn of_sim(
    _: Python<'_>,
    _: &Sim,
    _: &[String],
    _: Option<&Bound<'_, PyAny>>,
) -> PyResult<Linearization> {
    Err(missing())
}

/// Returns the same error.
pub(crate) fn of_batch(
    _: Python<'_>,
    _: &Batch,
    _: &[String],
    _: Option<&Bound<'_, PyAny>>,
) -> PyResult<Linearization> {
    Err(missing())
}

fn missing() -> PyErr {
    ClenchError::new_err(crate::device::without("derivatives", "derivatives"))
}
