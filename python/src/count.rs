//! Non-negative integer arguments. Python's integers have any size and sign; PyO3 raises a bare `OverflowError` for
//! those that a Rust type does not hold.

use pyo3::exceptions::{PyIndexError, PyOverflowError, PyValueError};
use pyo3::prelude::*;

/// A number of steps, environments or threads.
#[derive(Clone, Copy)]
pub(crate) struct Count(pub(crate) usize);

impl FromPyObject<'_, '_> for Count {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let py = object.py();
        object.extract().map(Count).map_err(|error| {
            if !error.is_instance_of::<PyOverflowError>(py) {
                return error;
            }
            PyValueError::new_err("a count must be 0 or more, and less than 2^64")
        })
    }
}

/// An index or a handle. Integers that are negative or too large become the largest one, which nothing has.
#[derive(Clone, Copy)]
pub(crate) struct Index(pub(crate) usize);

impl FromPyObject<'_, '_> for Index {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        match object.extract::<usize>() {
            Err(error) if error.is_instance_of::<PyOverflowError>(object.py()) => {
                Ok(Index(usize::MAX))
            }
            found => found.map(Index),
        }
    }
}

/// Returns an error if there is no environment with this index.
pub(crate) fn check_env(env: usize, envs: usize) -> PyResult<()> {
    if env < envs {
        return Ok(());
    }
    let text = format!("the environment must be at least 0 and below {envs}");
    Err(PyIndexError::new_err(text))
}

/// The number of pixels along a side of a picture.
#[derive(Clone, Copy)]
pub(crate) struct Pixels(pub(crate) u32);

impl FromPyObject<'_, '_> for Pixels {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let py = object.py();
        object.extract().map(Pixels).map_err(|error| {
            if !error.is_instance_of::<PyOverflowError>(py) {
                return error;
            }
            PyValueError::new_err(
                "a picture must have 1 or more pixels along a side, and less than 2^32",
            )
        })
    }
}
