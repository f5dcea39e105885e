//! `clench.Model`.

use crate::error::load_error;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A model: what never changes while stepping, shared by the simulations of it.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Model(Arc<clench::Model>);

impl Model {
    /// The model itself.
    pub(crate) fn inner(&self) -> &Arc<clench::Model> {
        &self.0
    }
}

#[pymethods]
impl Model {
    /// Load a model from an MJCF file.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let model = py.detach(|| clench::load(&path)).map_err(load_error)?;
        Ok(Model(Arc::new(model)))
    }

    /// Load a model from the text of an MJCF file.
    #[staticmethod]
    fn from_xml(py: Python<'_>, text: &str) -> PyResult<Self> {
        let model = py.detach(|| clench::load_str(text)).map_err(load_error)?;
        Ok(Model(Arc::new(model)))
    }
}
