//! Conversion of Python values to arrays of a required kind. Anything that NumPy converts is accepted.

use numpy::{
    Element, PyArray1, PyArrayDescr, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;

/// Converts a value to an array of `S` in C order, of any shape, copying if necessary; `name` is for messages.
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

/// Converts a value as [`numbers`] does, and requires this shape.
pub(crate) fn shaped<'py, S: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadonlyArrayDyn<'py, S>> {
    let array = numbers(name, value)?;
    require_shape(name, array.shape(), shape)?;
    Ok(array)
}

/// Returns the array of `S` over the memory of `out`, which is an array or a tensor that shares its memory by DLPack.
pub(crate) fn memory<'py, S: Element>(
    out: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<S>>> {
    let py = out.py();
    let array = match out.cast::<PyUntypedArray>() {
        Ok(_) => out.clone(),
        Err(_) if out.hasattr(intern!(py, "__dlpack__"))? => {
            numpy(py)?.call_method1(intern!(py, "from_dlpack"), (out,))?
        }
        Err(_) => out.clone(),
    };
    let Ok(array) = array.cast_into::<PyArrayDyn<S>>() else {
        let text = format!("out must be an array of {}", dtype::<S>(py));
        return Err(PyTypeError::new_err(text));
    };
    require_shape("out", array.shape(), shape)?;
    Ok(array)
}

/// Converts a value to `n` booleans, one for each element.
pub(crate) fn mask(name: &str, value: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<bool>> {
    let array = as_array(value)?;
    // NumPy makes an empty list an array of floats.
    if !array.is_empty() {
        require_kind(name, &array, b"b", "booleans")?;
    }
    require_shape(name, array.shape(), &[n])?;
    // Read as bytes: a NumPy boolean may be any byte, a Rust `bool` only 0 or 1.
    let bytes = numpy(value.py())?.call_method1("require", (array, dtype::<bool>(value.py())))?;
    let bytes = bytes.call_method1("view", ("u1",))?.cast_into()?;
    let bytes = contiguous::<u8>(&bytes)?;
    Ok(bytes.as_slice()?.iter().map(|&byte| byte != 0).collect())
}

/// Converts a value to indices of elements, counted from zero and less than `n`.
pub(crate) fn indices(name: &str, value: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<usize>> {
    let array = as_array(value)?;
    // NumPy makes an empty list an array of floats.
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

/// Returns an error if a number is not finite; it names the first one.
pub(crate) fn require_finite(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(PyValueError::new_err(format!(
            "{name} is not finite: number {i} is {}",
            values[i]
        ))),
    }
}

/// Returns an error if the shape differs from the needed one.
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

/// Formats a shape as Python does.
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

/// Converts a value to an array, copying if necessary.
pub(crate) fn as_array<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
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

/// Returns the same numbers in C order and native byte order, copied only if necessary.
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

/// Returns an array of the values that `read` takes from each row; `shape` is the shape of one row's values.
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
