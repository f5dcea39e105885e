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
    /// quaternions and axes are normalized. The numbers stay when an environment is reset. The other constants that follow, such
    /// as the inverse inertias by which constraints are scaled, stay the model's unless ``consistent`` is set (see
    /// `set_constants`).
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model, such as ``"body_mass"`` or ``"geom_friction"``; see `clench.PARAMETERS`.
    /// values : array_like
    ///     The whole field for each environment: its shape in the model after an axis over environments.
    /// envs : array_like of int, optional
    ///     Which environments; by default all.
    /// consistent : bool, optional
    ///     Whether to compute the constants that follow, as `set_constants` does. Of several fields set one after the other, only
    ///     the last needs it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A name that no parameter has, a wrong shape, or numbers that the field cannot have; all is then as before. With
    ///     ``consistent``, also a mass matrix that is not positive definite; the field is then set and the constants are as before.
    #[pyo3(signature = (field, values, envs = None, *, consistent = false))]
    fn randomize(
        &self,
        field: &str,
        values: &Bound<'_, PyAny>,
        envs: Option<&Bound<'_, PyAny>>,
        consistent: bool,
    ) -> PyResult<()> {
        let envs = match envs {
            Some(envs) => indices("envs", envs, self.n_envs)?,
            None => Vec::from_iter(0..self.n_envs),
        };
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => {
            let values = shaped(field, values, &[&[envs.len()], &shape[..]].concat())?;
            let set = batch.randomize(field, &envs, values.as_slice()?);
            set.and_then(|()| if consistent { batch.set_constants(&envs) } else { Ok(()) })
                .map_err(sim_error)
        })
    }

    /// Computes the constants that follow from the parameters of environments in the initial configuration ``qpos0``, as
    /// MuJoCo's ``mj_setConst`` does: the inverse inertias ``body_invweight0``, ``dof_invweight0`` and ``tendon_invweight0`` by
    /// which constraints are scaled, ``dof_length``, ``tendon_length0``, ``actuator_acc0``, frames of cameras (``cam_pos0``,
    /// ``cam_poscom0``, ``cam_mat0``), second anchors of connects, anchors at sites.
    ///
    /// Call it after masses, inertias, positions or armatures have changed, unless constraints are to stay as soft as those of
    /// the original model.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Which environments (n); by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An environment whose mass matrix is not positive definite. All is then as before.
    #[pyo3(signature = (mask = None))]
    fn set_constants(&self, py: Python<'_>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let envs = Vec::from_iter((0..self.n_envs).filter(|&env| chosen[env]));
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => py.detach(|| batch.set_constants(&envs)).map_err(sim_error))
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
