//! Changes of the input of a step and of its results, and gradients by them, as Python passes them.

use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The changes of x, of u and of parameters that a user chose.
pub(crate) type Changes<'a, 'py> = [Option<&'a Bound<'py, PyAny>>; 3];

/// dx⁺ and dy.
pub(crate) type Results = (Py<PyArrayDyn<f64>>, Py<PyArrayDyn<f64>>);

/// The gradients by x⁺ and y that a user gives.
pub(crate) type OutputGradients<'a, 'py> = [Option<&'a Bound<'py, PyAny>>; 2];

/// The gradients by x, by u, and by each parameter.
pub(crate) type InputGradients = (Py<PyArrayDyn<f64>>, Py<PyArrayDyn<f64>>, Py<PyDict>);
