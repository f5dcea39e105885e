//! Fields of a model as Python reads them: shapes and numbers.

use clench::Model;
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use std::ops::Range;

/// An array of numbers and its shape.
pub(crate) struct Field {
    pub(crate) shape: Vec<usize>,
    pub(crate) numbers: Numbers,
}

pub(crate) enum Numbers {
    Real(Vec<f64>),
    Code(Vec<i32>),
    Flag(Vec<bool>),
}

impl Field {
    /// Returns a float for a single number, else a read-only array.
    pub(crate) fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self.numbers {
            Numbers::Real(numbers) if self.shape.is_empty() => {
                Ok(numbers[0].into_pyobject(py)?.into_any())
            }
            Numbers::Real(numbers) => read_only(py, &self.shape, numbers),
            Numbers::Code(numbers) => read_only(py, &self.shape, numbers),
            Numbers::Flag(numbers) => read_only(py, &self.shape, numbers),
        }
    }
}

/// Returns a new read-only array.
pub(super) fn read_only<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    numbers: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), numbers).expect("shapes say how many");
    let array = PyArrayDyn::from_owned_array(py, array);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.into_any())
}

/// The name of a field and the function that reads it.
pub(crate) type Reader = (&'static str, fn(&Model) -> Field);

pub(crate) fn codes<E>(elements: &[E], code: impl Fn(&E) -> i32) -> Field {
    Field {
        shape: vec![elements.len()],
        numbers: Numbers::Code(elements.iter().map(code).collect()),
    }
}

pub(super) fn flags<E>(elements: &[E], flag: impl Fn(&E) -> bool) -> Field {
    Field {
        shape: vec![elements.len()],
        numbers: Numbers::Flag(elements.iter().map(flag).collect()),
    }
}

pub(super) fn reals<E>(elements: &[E], number: impl Fn(&E) -> f64) -> Field {
    Field {
        shape: vec![elements.len()],
        numbers: Numbers::Real(elements.iter().map(number).collect()),
    }
}

/// Returns a field of user data; every element has the same number of values.
pub(crate) fn user_rows<E>(elements: &[E], numbers: impl Fn(&E) -> &[f64]) -> Field {
    let width = elements.first().map_or(0, |first| numbers(first).len());
    Field {
        shape: vec![elements.len(), width],
        numbers: Numbers::Real(elements.iter().flat_map(numbers).copied().collect()),
    }
}

/// Converts an index or count. All are far below 2³¹: no memory holds that many elements.
pub(crate) fn id(index: usize) -> i32 {
    index as i32
}

pub(super) fn id_or_none(index: Option<usize>) -> i32 {
    index.map_or(NONE, id)
}

pub(super) fn first(range: &Range<usize>) -> i32 {
    id_or_none(Some(range.start).filter(|_| !range.is_empty()))
}

/// The index that stands for no element.
pub(super) const NONE: i32 = -1;
