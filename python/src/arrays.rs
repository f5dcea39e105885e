//! Arrays out of what Python gives: anything that NumPy takes for an array, of the kind that is meant.

use numpy::{
    Element, PyArray1, PyArrayDescr, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;

/// Numbers of any shape, converted to `S` and to C order where they are not yet; `name` is for messages.
///
/// Integers and booleans count as numbers, complex numbers and text do not.
pub(crate) fn numbers<'py, S: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, S>> {
    let array = as_array(value)?;
    require_kind(name, &array, b"fiub", "numbers")?;
    contiguous(&array)
}

/// Numbers of shape `shape`, as [`numbers`].
pub(crate) fn shaped<'py, S: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadonlyArrayDyn<'py, S>> {
    let array = numbers(name, value)?;
    require_shape(name, array.shape(), shape)?;
    Ok(array)
}

/// As many booleans as there are elements, `n`.
pub(crate) fn mask(name: &str, value: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<bool>> {
    let array = as_array(value)?;
    // An empty list is an array of floats to NumPy.
    if !array.is_empty() {
        require_kind(name, &array, b"b", "booleans")?;
    }
    require_shape(name, array.shape(), &[n])?;
    // As bytes: NumPy's booleans may be any byte, Rust's only 0 and 1.
    let bytes = numpy(value.py())?.call_method1("require", (array, dtype::<bool>(value.py())))?;
    let bytes = bytes.call_method1("view", ("u1",))?.cast_into()?;
    let bytes = contiguous::<u8>(&bytes)?;
    Ok(bytes.as_slice()?.iter().map(|&byte| byte != 0).collect())
}

/// Indices of some of `n` elements, each counted from zero.
pub(crate) fn indices(name: &str, value: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<usize>> {
    let array = as_array(value)?;
    // An empty list is an array of floats to NumPy.
    if !array.is_empty() {
        require_kind(name, &array, b"iu", "integers")?;
    }
    require_shape(name, array.shape(), &[array.len()])?;
    let index = |&i: &i64| match usize::try_from(i) {
        Ok(i) if i < n => Ok(i),
        _ => Err(PyIndexError::new_err(format!(
            "{name} has {i}, but indices go from 0 to {}",
            n as i64 - 1
        ))),
    };
    let array = contiguous::<i64>(&array)?;
    array.as_slice()?.iter().map(index).collect()
}

/// Nothing but finite numbers; the first other one is an error.
pub(crate) fn require_finite(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(PyValueError::new_err(format!(
            "{name} is not finite: number {i} is {}",
            values[i]
        ))),
    }
}

/// A shape other than that is an error.
pub(crate) fn require_shape(name: &str, found: &[usize], needed: &[usize]) -> PyResult<()> {
    if found == needed {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} has shape {}, but must have {}",
        shape_text(found),
        shape_text(needed)
    )))
}

/// A shape as Python writes it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => format!(
            "({})",
            Vec::from_iter(shape.iter().map(usize::to_string)).join(", ")
        ),
    }
}

fn numpy(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import(intern!(py, "numpy"))
}

fn as_array<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        return Ok(array.clone());
    }
    let array = numpy(value.py())?.call_method1("asarray", (value,))?;
    Ok(array.cast_into()?)
}

fn require_kind(
    name: &str,
    array: &Bound<'_, PyUntypedArray>,
    kinds: &[u8],
    what: &str,
) -> PyResult<()> {
    let found: Bound<'_, PyArrayDescr> = array.dtype();
    if kinds.contains(&found.kind()) {
        return Ok(());
    }
    Err(PyTypeError::new_err(format!(
        "{name} must be {what}, not of dtype {found}"
    )))
}

/// The same numbers in C order and native form, copied only where they are not so already.
fn contiguous<'py, S: Element>(
    array: &Bound<'py, PyUntypedArray>,
) -> PyResult<PyReadonlyArrayDyn<'py, S>> {
    let py = array.py();
    if let Ok(array) = array.cast::<PyArrayDyn<S>>()
        && array.is_c_contiguous()
        && array.is_aligned()
    {
        return Ok(array.try_readonly()?);
    }
    let array = numpy(py)?.call_method1("require", (array, dtype::<S>(py), "CA"))?;
    Ok(array.cast_into::<PyArrayDyn<S>>()?.try_readonly()?)
}

/// An array over rows, of what `read` takes from each: as many numbers as `shape` says.
pub(crate) fn column<Row, E: Element, const N: usize, Part: IntoIterator<Item = E>>(
    py: Python<'_>,
    rows: &[Row],
    shape: [usize; N],
    read: impl Fn(&Row) -> Part,
) -> PyResult<Py<PyAny>> {
    let array = PyArray1::from_vec(py, rows.iter().flat_map(read).collect());
    let shape = [&[rows.len()], &shape[..]].concat();
    Ok(array.reshape(shape)?.into_any().unbind())
}
