//! Replacement of `tangents` in a package that is built without derivatives.

use crate::changes::{Changes, Results};
use crate::derivatives::{Memory, without};
use crate::row_sim::AnySim;
use clench::rigid::batch::Precision;
use pyo3::prelude::*;
use std::convert::Infallible;

/// The changes of the input, which cannot exist.
pub(crate) struct Tangents(Infallible);

impl Tangents {
    /// Returns an error that says how to build a package with derivatives.
    pub(crate) fn new(
        _: &clench::Model,
        _: &[String],
        _: Changes<'_, '_>,
        _: &[usize],
    ) -> PyResult<Self> {
        Err(without())
    }

    pub(crate) fn of_sim(
        &self,
        _: Python<'_>,
        (): &mut Memory,
        _: &mut AnySim,
    ) -> PyResult<Results> {
        match self.0 {}
    }

    pub(crate) fn of_batch<S: Precision>(
        &self,
        _: Python<'_>,
        (): &mut (),
        _: &mut clench::Batch<S>,
    ) -> PyResult<Results> {
        match self.0 {}
    }
}
