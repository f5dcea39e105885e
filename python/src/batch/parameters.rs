//! Parameters of environments.

use super::{AnyBatch, Batch};
use crate::arrays::{indices, shaped};
use crate::busy::lock;
use crate::error::sim_error;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

#[pymethods]
impl Batch {
    /// Gives environments numbers of their own in place of the model's.
    ///
    /// What follows directly is computed with it (``body_subtreemass`` from ``body_mass``, ``geom_rbound`` from ``geom_size``);
    /// quaternions and axes are normalized. The numbers stay when an environment is reset.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model, such as ``"body_mass"`` or ``"geom_friction"``; see `clench.PARAMETERS`.
    /// values : array_like
    ///     The whole field for each environment: its shape in the model after an axis over environments.
    /// envs : array_like of int, optional
    ///     Which environments; by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A name that no parameter has, a wrong shape, or numbers that the field cannot have. All is then as before.
    #[pyo3(signature = (field, values, envs = None))]
    fn randomize(
        &self,
        field: &str,
        values: &Bound<'_, PyAny>,
        envs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let envs = match envs {
            Some(envs) => indices("envs", envs, self.n_envs)?,
            None => Vec::from_iter(0..self.n_envs),
        };
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => {
            let values = shaped(field, values, &[&[envs.len()], &shape[..]].concat())?;
            batch.randomize(field, &envs, values.as_slice()?).map_err(sim_error)
        })
    }

    /// The numbers of a parameter as each environment has them.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A copy: the field's shape in the model after an axis over environments.
    fn param<'py>(&self, py: Python<'py>, field: &str) -> PyResult<Bound<'py, PyAny>> {
        let shape = self.model.get().param_shape(field)?;
        let guard = lock(&self.inner, "batch")?;
        each!(&*guard, batch => {
            let mut all = Vec::new();
            for env in 0..self.n_envs {
                all.append(&mut batch.param(field, env).map_err(sim_error)?);
            }
            let shape = [&[self.n_envs], &shape[..]].concat();
            Ok(PyArray1::from_vec(py, all).reshape(shape)?.into_any())
        })
    }
}
