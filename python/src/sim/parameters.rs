//! Parameters of a simulation.

use super::Sim;
use crate::arrays::shaped;
use crate::busy::lock;
use crate::error::sim_error;
use crate::row_sim::{AnySim, each_sim};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

#[pymethods]
impl Sim {
    /// Replaces the values of a parameter in this simulation only.
    ///
    /// Directly dependent fields are updated too (``body_subtreemass`` from ``body_mass``, ``geom_rbound`` from
    /// ``geom_size``, the frames of equalities between sites from ``site_pos`` and ``site_quat``); quaternions and axes
    /// are normalized. Other dependent constants do not change until `set_constants`.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model, such as ``"body_mass"``; see `clench.PARAMETERS`.
    /// values : array_like
    ///     The whole field, in its shape in the model.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no parameter has the name, the shape is wrong, or a value is invalid for the field. Nothing changes then.
    fn set_param(&self, field: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let values = shaped(field, values, &shape)?;
            own.sim.set_param(field, values.as_slice()?).map_err(sim_error)
        })
    }

    /// Sets a parameter, also one that follows from another, for pickles; see `clench._pickle`.
    fn _restore_param(&self, field: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let values = shaped(field, values, &shape)?;
            own.sim.restore_param(field, values.as_slice()?).map_err(sim_error)
        })
    }

    /// Computes the constants that depend on the parameters in the initial configuration ``qpos0``, as MuJoCo's
    /// ``mj_setConst`` does: subtree masses, the inverse inertias ``body_invweight0``, ``dof_invweight0`` and
    /// ``tendon_invweight0`` that scale constraints, ``dof_length``, ``tendon_length0``, ``actuator_acc0``, added
    /// masses of ellipsoids in a medium, frames of cameras (``cam_pos0``, ``cam_poscom0``, ``cam_mat0``), second
    /// anchors of connects, poses of welds to which the model gives none, anchors at sites. Such anchors and poses are
    /// replaced even if `weld_here` wrote them. The state does not change.
    ///
    /// Call it after masses, inertias, positions or armatures have changed, unless constraints should keep the softness
    /// of the original model.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the mass matrix is not positive definite. Nothing changes then.
    fn set_constants(&self) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => own.sim.set_constants().map_err(sim_error))
    }

    /// Returns the values of a parameter in this simulation.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A copy in the field's shape in the model.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no parameter has the name.
    fn param<'py>(&self, py: Python<'py>, field: &str) -> PyResult<Bound<'py, PyAny>> {
        let shape = self.model.get().param_shape(field)?;
        let guard = lock(&self.inner, "simulation")?;
        each_sim!(&*guard, own => {
            let values = own.sim.param(field).map_err(sim_error)?;
            Ok(PyArray1::from_vec(py, values).reshape(shape)?.into_any())
        })
    }
}
