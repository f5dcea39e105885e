//! The models of a batch.

use super::{AnyBatch, Batch};
use crate::busy::lock;
use crate::count::Index;
use crate::error::sim_error;
use crate::model::Model;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

impl Batch {
    /// Returns the objects of the models.
    pub(crate) fn objects(&self) -> &[Py<Model>] {
        &self.models
    }

    /// Returns the object of the model of an environment.
    pub(crate) fn model_of(&self, batch: &AnyBatch, env: usize) -> &Py<Model> {
        &self.models[each!(batch, batch => batch.env_model(env))]
    }
}

#[pymethods]
impl Batch {
    /// tuple of Model : The models of the environments.
    #[getter]
    fn models<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.models)
    }

    /// numpy.ndarray : The model of each environment (n), an index of `models`, int64. A copy: `reset` changes models.
    #[getter]
    fn env_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let guard = lock(&self.inner, "batch")?;
        let model = |env| each!(&*guard, batch => batch.env_model(env)) as i64;
        Ok(PyArray1::from_iter(py, (0..self.n_envs).map(model)))
    }

    /// Returns the index in `Batch.model` of each geom of one of several models.
    ///
    /// Parameters
    /// ----------
    /// model : int
    ///     The index of a model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     One index per geom of ``models[model]``, ascending, int64. ``batch.geom_xpos[env, batch.geoms_of(m)]`` are
    ///     the positions of the geoms of an environment with model ``m``.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such model.
    fn geoms_of<'py>(&self, py: Python<'py>, model: Index) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let guard = lock(&self.inner, "batch")?;
        let geoms = each!(&*guard, batch => batch.geoms_of(model.0)).map_err(sim_error)?;
        Ok(PyArray1::from_iter(
            py,
            geoms.iter().map(|&geom| geom as i64),
        ))
    }
}
