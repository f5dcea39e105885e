//! Exact derivatives of a step: methods of `Sim` and `Batch`.

use crate::batch::{AnyBatch, Batch};
use crate::busy::lock;
use crate::derivatives::Chosen;
use crate::differentiated::Derivative;
use crate::linearization::Linearization;
use crate::one_or_many::one_or_many;
use crate::sim::Sim;
use pyo3::prelude::*;

impl Sim {
    pub(crate) fn differentiate<D: Derivative>(
        &self,
        py: Python<'_>,
        wanted: &D,
    ) -> PyResult<D::Result> {
        let mut memory = lock(self.linearizer(), "simulation")?;
        let mut guard = lock(self.inner(), "simulation")?;
        wanted.of_sim(py, &mut memory, &mut guard)
    }
}

impl Batch {
    pub(crate) fn differentiate<D: Derivative>(
        &self,
        py: Python<'_>,
        wanted: &D,
    ) -> PyResult<D::Result> {
        let mut memory = lock(self.linearizer(), "batch")?;
        let mut guard = lock(self.inner(), "batch")?;
        match &mut *guard {
            AnyBatch::F64(batch) => wanted.of_batch(py, &mut memory.double, batch),
            AnyBatch::F32(batch) => wanted.of_batch(py, &mut memory.single, batch),
        }
    }
}

one_or_many! {
    /// Computes the exact derivatives of the next step, of every environment of a `Batch`, like MuJoCo's
    /// ``mjd_transitionFD`` without finite differences.
    ///
    /// Every feature of a step has derivatives: contacts that move, all cones, equalities, actuators, fluids,
    /// integrators, noslip. The derivative of a constraint that switches is that of the active side; that of a control
    /// or activation at an end of its range is that of the inside. Derivatives are computed in double precision. The
    /// state does not change.
    ///
    /// Parameters
    /// ----------
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y; see `clench.OUTPUTS`.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters to differentiate by (see `clench.PARAMETERS`), or inputs of the state: ``qfrc_applied``,
    ///     ``xfrc_applied``, ``mocap_pos``, ``mocap_quat``. All numbers, or those at the given indices of the flattened
    ///     field. ``body_subtreemass`` follows ``body_mass``; other derived constants stay the same, as in `set_param`.
    /// memory : bool
    ///     True to extend x by the other fields that a step changes, in this order: ``plastic``, ``history``,
    ///     ``stick_references``, ``stick_friction``. Products of matrices over several steps then contain delays,
    ///     springs that yield, and stiction.
    /// sensors : bool
    ///     False to omit the sensors from y: most models with sensors then take a third of the time.
    /// errors : bool
    ///     True to bound the errors that the tolerance of the solver leaves; takes a second solve.
    ///
    /// Returns
    /// -------
    /// Linearization
    ///     The matrices; those of a `Batch` are stacked.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, or a parameter follows from another.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If `step` of a `Sim` would raise it, or the step of an environment fails.
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
    #[pyo3(signature = (outputs = Vec::new(), parameters = None, *, memory = false, sensors = true, errors = false),
           text_signature = "($self, outputs=(), parameters=None, *, memory=False, sensors=True, errors=False)")]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
        memory: bool,
        sensors: bool,
        errors: bool,
    ) -> PyResult<Linearization> {
        let kinds = [memory, sensors, errors];
        self.differentiate(py, &Chosen::new(self.described(), &outputs, parameters, kinds)?)
    }
}
