//! Results as arrays: new ones or an `out` array of the caller, and functions that apply to each row.

use crate::arrays::{memory, numbers, shape_text};
use crate::error::sim_error;
use clench::{Precision, SimError};
use numpy::{Element, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the numbers in a new array of this shape, or writes them to `out` if it is given.
pub(crate) fn answer<'py, S: Element + Copy>(
    py: Python<'py>,
    values: Vec<S>,
    shape: &[usize],
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(out) = out else {
        return Ok(PyArray1::from_vec(py, values).reshape(shape)?.into_any());
    };
    let mut writable = memory::<S>(out, shape)?.try_readwrite()?;
    for (to, value) in writable.as_array_mut().iter_mut().zip(values) {
        *to = value;
    }
    Ok(out.clone())
}

/// Applies `change` to each row of `width` numbers; `values` is a single row or any number of rows.
pub(crate) fn each_row<'py, S: Precision + Element>(
    name: &str,
    values: &Bound<'py, PyAny>,
    width: usize,
    mut change: impl FnMut(&mut [S]) -> Result<(), SimError>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = numbers::<S>(name, values)?;
    let shape = array.shape().to_vec();
    if !matches!(shape[..], [own] | [_, own] if own == width) {
        return Err(PyValueError::new_err(format!(
            "{name} has shape {}, but must have ({width},) or (k, {width})",
            shape_text(&shape)
        )));
    }
    let mut all = array.as_slice()?.to_vec();
    for row in all.chunks_exact_mut(width.max(1)) {
        change(row).map_err(sim_error)?;
    }
    answer(values.py(), all, &shape, None)
}
