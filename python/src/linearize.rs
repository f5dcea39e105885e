//! Exact derivatives of a step: the class of results, and the methods that compute them.

use crate::batch::Batch;
use crate::derivatives;
use crate::sim::Sim;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The linear model of a step about a state: x⁺ changes by A dx + B du, y by C dx + D du.
///
/// x holds the motion of the positions along the dofs (nv; rotations about the axes of the child, rad), then the
/// velocities (nv) and the activations (na). u holds the controls (nu). y holds the sensors (nsensordata), then the
/// outputs that were asked for, row after row, of the state before the step. The matrices of a batch are stacked, (n,
/// rows, columns).
#[pyclass(frozen, get_all, module = "clench")]
#[allow(non_snake_case)] // Named as in control theory.
pub(crate) struct Linearization {
    /// numpy.ndarray : ∂x⁺/∂x.
    pub(crate) A: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂x⁺/∂u.
    pub(crate) B: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂x.
    pub(crate) C: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂u.
    pub(crate) D: Py<PyArrayDyn<f64>>,
    /// dict[str, numpy.ndarray] : ∂x⁺/∂p by parameter, with a column for each of its numbers that was asked for.
    pub(crate) parameters: Py<PyDict>,
    /// dict[str, numpy.ndarray] : ∂y/∂p, likewise.
    pub(crate) output_parameters: Py<PyDict>,
    /// numpy.ndarray : The distance of each constraint row, in the order of `Sim.constraints`, from a change of its state
    /// (a contact that begins to slip, a limit that lets go), where its force has no derivative; m/s² or rad/s²,
    /// infinite for rows that always act. Of a batch, a list of arrays.
    pub(crate) switching: Py<PyAny>,
}

#[pymethods]
impl Sim {
    /// Computes the exact derivatives of the next step, like MuJoCo's ``mjd_transitionFD`` without finite differences.
    ///
    /// Every feature of a step has derivatives: contacts that move, all cones, equalities, actuators, fluids,
    /// integrators, noslip. The derivative of a constraint that switches is that of the active side. Derivatives are
    /// computed in double precision. The state does not change.
    ///
    /// Parameters
    /// ----------
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y; see `clench.OUTPUTS`.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters to differentiate by (see `clench.PARAMETERS`): all numbers, or those at the given indices of the
    ///     flattened field. ``body_subtreemass`` follows ``body_mass``; other derived constants stay the same, as in
    ///     `set_param`.
    ///
    /// Returns
    /// -------
    /// Linearization
    ///     The matrices.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, or a parameter follows from another.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If `step` would raise it.
    ///
    /// Examples
    /// --------
    /// >>> import clench
    /// >>> sim = clench.Sim(clench.Model.from_xml(
    /// ...     "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/>"
    /// ...     "<geom size='0.1' mass='2'/></body></worldbody>"
    /// ...     "<actuator><motor joint='x'/></actuator></mujoco>"))
    /// >>> sim.linearize().B.tolist()
    /// [[5e-05], [0.005]]
    #[pyo3(signature = (outputs = Vec::new(), parameters = None),
           text_signature = "(outputs=(), parameters=None)")]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Linearization> {
        derivatives::of_sim(py, self, &outputs, parameters)
    }
}

#[pymethods]
impl Batch {
    /// Computes the exact derivatives of the next step of every environment; see `Sim.linearize`.
    ///
    /// Parameters
    /// ----------
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters to differentiate by.
    ///
    /// Returns
    /// -------
    /// Linearization
    ///     The matrices, stacked.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or the batch has single precision: derivatives are
    ///     computed in double precision.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If the step of an environment fails.
    #[pyo3(signature = (outputs = Vec::new(), parameters = None),
           text_signature = "(outputs=(), parameters=None)")]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Linearization> {
        derivatives::of_batch(py, self, &outputs, parameters)
    }
}
