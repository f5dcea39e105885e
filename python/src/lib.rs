//! The compiled part of the Python package `clench`.

use pyo3::prelude::*;

#[pymodule]
mod _core {}
