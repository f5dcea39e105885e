//! Rows of numbers as NumPy arrays, without a copy. Making such an array is `unsafe`, here and in the callers that hand in rows.
//!
//! A table of `clench` keeps its numbers in one place as long as it lives. A view is a NumPy array over that place whose base
//! is a [`Keeper`]: as long as anyone holds the view, the table lives. Who writes from another thread while a call steps gets
//! numbers that are partly old and partly new: a step reads each number once and atomically into scratch of its own, checks it
//! there, and stores results atomically. Arrays that calls are given are copied before other threads run.

use crate::arrays::shape_text;
use numpy::ndarray::{ArrayViewD, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::Arc;

/// What views have as their base: it keeps the memory that they show.
#[pyclass(frozen, module = "clench._core")]
pub(crate) struct Keeper {
    _kept: Arc<dyn Any + Send + Sync>,
}

impl Keeper {
    /// A keeper of what owns the numbers.
    pub(crate) fn new(
        py: Python<'_>,
        kept: Arc<dyn Any + Send + Sync>,
    ) -> PyResult<Bound<'_, Self>> {
        Bound::new(py, Keeper { _kept: kept })
    }
}

/// A writable array over the numbers that begin at `start`.
///
/// # Errors
/// A shape that NumPy refuses, as that of an empty table can be.
///
/// # Safety
/// As many numbers as `shape` says lie there, row after row, as long as `keeper` lives, and do not move.
pub(crate) unsafe fn view<'py, E: Element>(
    keeper: &Bound<'py, Keeper>,
    start: *const E,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<E>>> {
    // NumPy leaves out the axes without entries when it adds up bytes.
    let mut counts = shape.iter().filter(|&&count| count > 0);
    let bytes = counts.try_fold(size_of::<E>(), |bytes, &count| bytes.checked_mul(count));
    if bytes.is_none_or(|bytes| isize::try_from(bytes).is_err()) {
        let text = format!("NumPy has no arrays of shape {}", shape_text(shape));
        return Err(PyMemoryError::new_err(text));
    }
    // SAFETY: by the caller's promise. NumPy is given the pointer; the reference ends with this function.
    unsafe {
        let numbers = ArrayViewD::from_shape_ptr(IxDyn(shape), start);
        Ok(PyArrayDyn::borrow_from_array(
            &numbers,
            keeper.clone().into_any(),
        ))
    }
}

/// The same array, which Python can no longer write.
pub(crate) fn read_only<'py, E: Element>(
    array: Bound<'py, PyArrayDyn<E>>,
) -> PyResult<Bound<'py, PyArrayDyn<E>>> {
    array.try_readwrite()?.make_nonwriteable();
    Ok(array)
}
