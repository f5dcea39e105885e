//! Rows of numbers as NumPy arrays, without a copy. Creating such an array is `unsafe`, here and in the callers that
//! pass rows.
//!
//! A table of `clench` stays at one address as long as it lives. A view is a NumPy array over that memory whose base is
//! a [`Keeper`]: the table lives as long as any view. If another thread writes during a step, the step sees a mix of
//! old and new numbers: it reads each number once and atomically into its own scratch, checks it there, and stores
//! results atomically. Arrays that are passed to calls are copied before other threads run.

use crate::arrays::shape_text;
use numpy::ndarray::{ArrayViewD, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::Arc;

/// The base object of views: it owns the memory that they show.
#[pyclass(frozen, module = "clench._core")]
pub(crate) struct Keeper {
    _owner: Arc<dyn Any + Send + Sync>,
}

impl Keeper {
    /// Creates a keeper of the owner of the numbers.
    pub(crate) fn new(
        py: Python<'_>,
        owner: Arc<dyn Any + Send + Sync>,
    ) -> PyResult<Bound<'_, Self>> {
        Bound::new(py, Keeper { _owner: owner })
    }
}

/// Creates a writable array over the numbers that begin at `start`.
///
/// # Errors
/// Returns an error if NumPy refuses the shape, which can happen for an empty table.
///
/// # Safety
/// The memory must hold as many numbers as `shape` states, in row-major order, and must stay valid and in place as long
/// as `keeper` lives.
pub(crate) unsafe fn view<'py, E: Element>(
    keeper: &Bound<'py, Keeper>,
    start: *const E,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<E>>> {
    // NumPy omits empty axes when it computes the size in bytes.
    let mut counts = shape.iter().filter(|&&count| count > 0);
    let bytes = counts.try_fold(size_of::<E>(), |bytes, &count| bytes.checked_mul(count));
    if bytes.is_none_or(|bytes| isize::try_from(bytes).is_err()) {
        let text = format!("NumPy has no arrays of shape {}", shape_text(shape));
        return Err(PyMemoryError::new_err(text));
    }
    // SAFETY: by the caller's promise. NumPy receives the pointer; the reference ends with this function.
    unsafe {
        let numbers = ArrayViewD::from_shape_ptr(IxDyn(shape), start);
        Ok(PyArrayDyn::borrow_from_array(
            &numbers,
            keeper.clone().into_any(),
        ))
    }
}

/// Makes an array read-only for Python.
pub(crate) fn read_only<'py, E: Element>(
    array: Bound<'py, PyArrayDyn<E>>,
) -> PyResult<Bound<'py, PyArrayDyn<E>>> {
    array.try_readwrite()?.make_nonwriteable();
    Ok(array)
}
