//! Requests for derivatives of steps, and the memory that they are computed in.

use crate::row_sim::AnySim;
use clench::rigid::batch::Precision;
use pyo3::prelude::*;

/// The memory of a simulation's derivatives, created on demand.
#[cfg(feature = "derivatives")]
pub(crate) type Memory = Option<clench::derivatives::Linearizer>;
/// The memory of a batch's derivatives in a precision, created on demand.
#[cfg(feature = "derivatives")]
pub(crate) type Own<S> = Option<clench::derivatives::BatchLinearizer<S>>;

/// The memory of a simulation's derivatives: none.
#[cfg(not(feature = "derivatives"))]
pub(crate) type Memory = ();
/// The memory of a batch's derivatives: none.
#[cfg(not(feature = "derivatives"))]
pub(crate) type Own<S> = std::marker::PhantomData<S>;

/// The memory of a batch's derivatives.
#[derive(Default)]
pub(crate) struct BatchMemory {
    pub(crate) double: Own<f64>,
    pub(crate) single: Own<f32>,
}

/// A request for derivatives.
pub(crate) trait Derivative {
    /// The derivatives as arrays.
    type Result;

    /// Differentiates the next steps of a simulation.
    fn of_sim(
        &self,
        py: Python<'_>,
        memory: &mut Memory,
        sim: &mut AnySim,
    ) -> PyResult<Self::Result>;

    /// Differentiates the next steps of every environment of a batch.
    fn of_batch<S: Precision>(
        &self,
        py: Python<'_>,
        memory: &mut Own<S>,
        batch: &mut clench::Batch<S>,
    ) -> PyResult<Self::Result>;
}
