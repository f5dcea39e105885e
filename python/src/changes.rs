//! Changes of the input of a step and of its results, as Python passes them.

use numpy::PyArrayDyn;
use pyo3::prelude::*;

/// The changes of x, of u and of parameters that a user chose.
pub(crate) type Changes<'a, 'py> = [Option<&'a Bound<'py, PyAny>>; 3];

/// dx⁺ and dy.
pub(crate) type Results = (Py<PyArrayDyn<f64>>, Py<PyArrayDyn<f64>>);
