//! Gradients of functions of a step: methods of `Sim` and `Batch`.

use crate::batch::{AnyBatch, Batch};
use crate::busy::lock;
use crate::changes::{InputGradients, Results};
use crate::gradients::{Gradients, Rollouts};
use crate::sim::Sim;
use pyo3::prelude::*;

#[pymethods]
impl Sim {
    /// Computes the gradient of a function of the next step's results by its input: x A + y C and x B + y D with the
    /// matrices of `linearize`. The state does not change.
    ///
    /// Parameters
    /// ----------
    /// x : array_like, shape (2 nv + na,), optional
    ///     Gradient by the next x: by the motion of the positions along the dofs, the velocities and the activations;
    ///     with ``memory``, also by the other fields that a step changes. By default zero.
    /// y : array_like, optional
    ///     Gradient by y: the sensors, then the chosen outputs. Without it y has no sensors, which saves time.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters or inputs to differentiate by, as in `linearize`.
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y; see `clench.OUTPUTS`.
    /// memory : bool
    ///     True to extend x as in `linearize`.
    ///
    /// Returns
    /// -------
    /// tuple
    ///     The gradients by x and by the controls, and a dictionary of those by parameters.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or an array has another shape or is not finite.
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
    /// ...     "<geom size='0.1' mass='2'/></body></worldbody></mujoco>"))
    /// >>> sim.vjp([1, 0])[0].tolist()
    /// [1.0, 0.01]
    #[pyo3(signature = (x = None, y = None, parameters = None, outputs = Vec::new(), *, memory = false),
           text_signature = "($self, x=None, y=None, parameters=None, outputs=(), *, memory=False)")]
    fn vjp(
        &self,
        py: Python<'_>,
        x: Option<&Bound<'_, PyAny>>,
        y: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyAny>>,
        outputs: Vec<String>,
        memory: bool,
    ) -> PyResult<InputGradients> {
        let model = self.described();
        let gradients = Gradients::new(model, &outputs, parameters, memory, [x, y], &[])?;
        let mut memory = lock(self.linearizer(), "simulation")?;
        let mut guard = lock(self.inner(), "simulation")?;
        gradients.of_sim(py, &mut memory, &mut guard)
    }

    /// Computes the gradient of a function of the states after each of the next T steps. The state does not change. The
    /// memory is that of A and B of each step except the last.
    ///
    /// Parameters
    /// ----------
    /// ctrl : array_like, shape (T, nu)
    ///     Controls of each step.
    /// x : array_like, shape (T, 2 nv + na)
    ///     Gradient by x after each step; see `vjp`.
    /// memory : bool
    ///     True to extend x as in `linearize`.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     The gradients by the first x, shape (2 nv + na,), and by the controls, (T, nu).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an array has another shape or is not finite.
    /// SimulationError
    ///     If `step` would raise it in any step.
    #[pyo3(signature = (ctrl, x, *, memory = false), text_signature = "($self, ctrl, x, *, memory=False)")]
    fn rollout_vjp(
        &self,
        py: Python<'_>,
        ctrl: &Bound<'_, PyAny>,
        x: &Bound<'_, PyAny>,
        memory: bool,
    ) -> PyResult<Results> {
        let rollouts = Rollouts::of_arrays(self.described(), ctrl, x, memory, &[])?;
        let mut memory = lock(self.linearizer(), "simulation")?;
        let mut guard = lock(self.inner(), "simulation")?;
        rollouts.of_sim(py, &mut memory, &mut guard)
    }
}

#[pymethods]
impl Batch {
    /// Computes the gradient of a function of the next step's results in every environment, each of its own function;
    /// see `Sim.vjp`.
    ///
    /// Parameters
    /// ----------
    /// x : array_like, shape (n, 2 nv + na), optional
    ///     Gradients by the next x.
    /// y : array_like, optional
    ///     Gradients by y, a row for each environment.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters or inputs to differentiate by.
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y.
    /// memory : bool
    ///     True to extend x.
    ///
    /// Returns
    /// -------
    /// tuple
    ///     The gradients by x and by the controls, and a dictionary of those by parameters; a row for each environment.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or an array has another shape or is not finite.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If the step of an environment fails.
    #[pyo3(signature = (x = None, y = None, parameters = None, outputs = Vec::new(), *, memory = false),
           text_signature = "($self, x=None, y=None, parameters=None, outputs=(), *, memory=False)")]
    fn vjp(
        &self,
        py: Python<'_>,
        x: Option<&Bound<'_, PyAny>>,
        y: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyAny>>,
        outputs: Vec<String>,
        memory: bool,
    ) -> PyResult<InputGradients> {
        let model = self.described();
        let mut linearizer = lock(self.linearizer(), "batch")?;
        let mut guard = lock(self.inner(), "batch")?;
        let count = match &*guard {
            AnyBatch::F64(batch) => batch.count(),
            AnyBatch::F32(batch) => batch.count(),
        };
        let gradients = Gradients::new(model, &outputs, parameters, memory, [x, y], &[count])?;
        match &mut *guard {
            AnyBatch::F64(batch) => gradients.of_batch(py, &mut linearizer.double, batch),
            AnyBatch::F32(batch) => gradients.of_batch(py, &mut linearizer.single, batch),
        }
    }
    /// Computes the gradients of functions of the states after each of the next T steps of every environment; see
    /// `Sim.rollout_vjp`.
    ///
    /// Parameters
    /// ----------
    /// ctrl : array_like, shape (T, n, nu)
    ///     Controls of each step.
    /// x : array_like, shape (T, n, 2 nv + na)
    ///     Gradients by x after each step.
    /// memory : bool
    ///     True to extend x.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     The gradients by the first x, shape (n, 2 nv + na), and by the controls, (T, n, nu).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an array has another shape or is not finite.
    /// SimulationError
    ///     If a step of an environment fails.
    #[pyo3(signature = (ctrl, x, *, memory = false), text_signature = "($self, ctrl, x, *, memory=False)")]
    fn rollout_vjp(
        &self,
        py: Python<'_>,
        ctrl: &Bound<'_, PyAny>,
        x: &Bound<'_, PyAny>,
        memory: bool,
    ) -> PyResult<Results> {
        let mut linearizer = lock(self.linearizer(), "batch")?;
        let mut guard = lock(self.inner(), "batch")?;
        let count = match &*guard {
            AnyBatch::F64(batch) => batch.count(),
            AnyBatch::F32(batch) => batch.count(),
        };
        let rollouts = Rollouts::of_arrays(self.described(), ctrl, x, memory, &[count])?;
        match &mut *guard {
            AnyBatch::F64(batch) => rollouts.of_batch(py, &mut linearizer.double, batch),
            AnyBatch::F32(batch) => rollouts.of_batch(py, &mut linearizer.single, batch),
        }
    }
}
