//! The compiled part of the Python package `clench`.

mod arrays;
mod element;
mod error;
mod fields;
mod kind;
mod model;
mod names;
mod option_values;
mod options;
mod stats;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::element::Element;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::options::RigidOptions;
    #[pymodule_export]
    use crate::stats::SolverStats;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // Python's name.
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
