//! Arguments of queries: the same for all environments, or different for each.

use crate::arrays::{numbers, require_shape, shape_text};
use clench::{Precision, QueryInput};
use numpy::{Element, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Numbers that are the same for all environments, or different for each.
pub(crate) struct Table<S> {
    pub(crate) values: Vec<S>,
    pub(crate) each: bool,
    /// The number of rows per environment.
    pub(crate) rows: usize,
}

impl<S: Precision + Element> Table<S> {
    /// Returns no numbers.
    pub(crate) fn empty() -> Self {
        Table {
            values: Vec::new(),
            each: false,
            rows: 1,
        }
    }

    /// Reads rows of `width` numbers: (k, width) or, for `n` environments, (n, k, width).
    pub(crate) fn rows_of(
        name: &str,
        values: &Bound<'_, PyAny>,
        width: usize,
        n: Option<usize>,
    ) -> PyResult<Self> {
        let array = numbers::<S>(name, values)?;
        let (each, rows) = match (array.shape(), n) {
            (&[rows, own], _) if own == width => (false, rows),
            (&[envs, rows, own], Some(n)) if own == width && envs == n => (true, rows),
            (other, _) => {
                let all = n.map_or_else(String::new, |n| format!(" or ({n}, k, {width})"));
                let found = shape_text(other);
                return Err(PyValueError::new_err(format!(
                    "{name} has shape {found}, but must have (k, {width}){all}"
                )));
            }
        };
        let values = array.as_slice()?.to_vec();
        Ok(Table { values, each, rows })
    }

    /// Reads one row of `width` numbers: (width,) or, for `n` environments, (n, width).
    pub(crate) fn row_of(
        name: &str,
        values: &Bound<'_, PyAny>,
        width: usize,
        n: Option<usize>,
    ) -> PyResult<Self> {
        let array = numbers::<S>(name, values)?;
        let each = array.shape().len() == 2 && n.is_some();
        let needed = match n.filter(|_| each) {
            Some(n) => vec![n, width],
            None => vec![width],
        };
        require_shape(name, array.shape(), &needed)?;
        let values = array.as_slice()?.to_vec();
        let rows = 1;
        Ok(Table { values, each, rows })
    }

    /// Returns the numbers in the form that a batch requires.
    pub(crate) fn input(&self) -> QueryInput<'_, S> {
        match self.each {
            true => QueryInput::Each(&self.values),
            false => QueryInput::Shared(&self.values),
        }
    }

    /// Returns the row of an environment, of `width` numbers.
    pub(crate) fn row(&self, env: usize, width: usize) -> &[S] {
        match self.each {
            true => &self.values[env * width..][..width],
            false => &self.values,
        }
    }

    /// Returns true if each environment has its own numbers.
    pub(crate) fn is_each(&self) -> bool {
        self.each
    }
}
