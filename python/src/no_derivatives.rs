//! Replacement of `derivatives`, `tangents` and `gradients` in a package that is built without them.

use crate::changes::{Changes, InputGradients, OutputGradients, Results};
use crate::differentiated::{Derivative, Memory, Own};
use crate::error::classes::ClenchError;
use crate::linearization::Linearization;
use crate::row_sim::AnySim;
use clench::rigid::batch::Precision;
use pyo3::prelude::*;
use std::convert::Infallible;
use std::marker::PhantomData;

/// A request for derivatives, which cannot exist.
pub(crate) struct Absent<R>(Infallible, PhantomData<R>);

/// The chosen outputs and parameters.
pub(crate) type Chosen = Absent<Linearization>;
/// The changes of the input.
pub(crate) type Tangents = Absent<Results>;
/// The gradients by the results.
pub(crate) type Gradients = Absent<InputGradients>;
/// The controls of rollouts, and the gradients by their states.
pub(crate) type Rollouts = Absent<Results>;

impl Chosen {
    pub(crate) fn new(
        _: &clench::Model,
        _: &[String],
        _: Option<&Bound<'_, PyAny>>,
        _: [bool; 3],
    ) -> PyResult<Self> {
        Err(without())
    }
}

impl Tangents {
    pub(crate) fn new(
        _: &clench::Model,
        _: &[String],
        _: Changes<'_, '_>,
        _: &[usize],
    ) -> PyResult<Self> {
        Err(without())
    }
}

impl Gradients {
    pub(crate) fn new(
        _: &clench::Model,
        _: &[String],
        _: Option<&Bound<'_, PyAny>>,
        _: bool,
        _: OutputGradients<'_, '_>,
        _: &[usize],
    ) -> PyResult<Self> {
        Err(without())
    }
}

impl Rollouts {
    pub(crate) fn of_arrays(
        _: &clench::Model,
        _: &Bound<'_, PyAny>,
        _: &Bound<'_, PyAny>,
        _: bool,
        _: &[usize],
    ) -> PyResult<Self> {
        Err(without())
    }
}

impl<R> Derivative for Absent<R> {
    type Result = R;

    fn of_sim(&self, _: Python<'_>, (): &mut Memory, _: &mut AnySim) -> PyResult<R> {
        match self.0 {}
    }

    fn of_batch<S: Precision>(
        &self,
        _: Python<'_>,
        _: &mut Own<S>,
        _: &mut clench::Batch<S>,
    ) -> PyResult<R> {
        match self.0 {}
    }
}

/// Returns an error that says how to build a package with derivatives.
fn without() -> PyErr {
    ClenchError::new_err(crate::device::without("derivatives", "derivatives"))
}
