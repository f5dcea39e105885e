//! Parameters of environments.

use super::{AnyBatch, Batch};
use crate::arrays::{indices, shaped};
use crate::busy::lock;
use crate::error::sim_error;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

#[pymethods]
impl Batch {
    /// Gives environments their own values of a parameter in place of the model's.
    ///
    /// Directly dependent fields are updated too (``body_subtreemass`` from ``body_mass``, ``geom_rbound`` from
    /// ``geom_size``, the frames of equalities between sites from ``site_pos`` and ``site_quat``); quaternions and axes
    /// are normalized. A reset keeps the values. The other dependent constants, such as the inverse inertias that scale
    /// constraints, stay the model's unless ``consistent`` is set (see `set_constants`).
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model, such as ``"body_mass"`` or ``"geom_friction"``; see `clench.PARAMETERS`.
    /// values : array_like
    ///     The whole field for each environment: its shape in the model after an axis of environments.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    /// consistent : bool, optional
    ///     True to compute the dependent constants, as `set_constants` does. If several fields are set in sequence,
    ///     only the last call needs it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no parameter has the name, the shape is wrong, or a value is invalid for the field; nothing changes then.
    ///     With ``consistent``, also if a mass matrix is not positive definite; the field is then set and the constants
    ///     do not change.
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

    /// Sets a parameter of all environments, also one that follows from another, for pickles; see `clench._pickle`.
    fn _restore_param(&self, field: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => {
            let values = shaped(field, values, &[&[self.n_envs], &shape[..]].concat())?;
            batch.restore_param(field, values.as_slice()?).map_err(sim_error)
        })
    }

    /// Computes the constants that depend on the parameters of environments in the initial configuration ``qpos0``, as
    /// MuJoCo's ``mj_setConst`` does: the inverse inertias ``body_invweight0``, ``dof_invweight0`` and
    /// ``tendon_invweight0`` that scale constraints, ``dof_length``, ``tendon_length0``, ``actuator_acc0``, frames of
    /// cameras (``cam_pos0``, ``cam_poscom0``, ``cam_mat0``), second anchors of connects, anchors at sites.
    ///
    /// Call it after masses, inertias, positions or armatures have changed, unless constraints should keep the softness
    /// of the original model.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Mask of environments (n); by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the mass matrix of an environment is not positive definite. Nothing changes then.
    #[pyo3(signature = (mask = None))]
    fn set_constants(&self, py: Python<'_>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let envs = Vec::from_iter((0..self.n_envs).filter(|&env| chosen[env]));
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => py.detach(|| batch.set_constants(&envs)).map_err(sim_error))
    }

    /// Returns the values of a parameter in every environment.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A copy: the field's shape in the model after an axis of environments.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no parameter has the name.
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
