//! Replacement of `derivatives` in a package that is built without them.

use crate::error::classes::ClenchError;
use crate::linearization::Linearization;
use crate::row_sim::AnySim;
use clench::rigid::batch::Precision;
use pyo3::prelude::*;
use std::convert::Infallible;

/// The memory of a simulation's derivatives: none.
pub(crate) type Memory = ();
/// The memory of a batch's derivatives: none.
#[derive(Default)]
pub(crate) struct BatchMemory {
    pub(crate) double: (),
    pub(crate) single: (),
}

/// The chosen outputs and parameters, which cannot exist.
pub(crate) struct Chosen(Infallible);

impl Chosen {
    /// Returns an error that says how to build a package with derivatives.
    pub(crate) fn new(
        _: &clench::Model,
        _: &[String],
        _: Option<&Bound<'_, PyAny>>,
        _: [bool; 3],
    ) -> PyResult<Self> {
        Err(without())
    }

    pub(crate) fn of_sim(
        &self,
        _: Python<'_>,
        (): &mut Memory,
        _: &mut AnySim,
    ) -> PyResult<Linearization> {
        match self.0 {}
    }

    pub(crate) fn of_batch<S: Precision>(
        &self,
        _: Python<'_>,
        (): &mut (),
        _: &mut clench::Batch<S>,
    ) -> PyResult<Linearization> {
        match self.0 {}
    }
}

/// Returns an error that says how to build a package with derivatives.
pub(crate) fn without() -> PyErr {
    ClenchError::new_err(crate::device::without("derivatives", "derivatives"))
}
