//! Gradients of functions of a step: methods of `Sim` and `Batch`.

use crate::changes::{InputGradients, Results};
use crate::gradients::{Gradients, Rollouts};
use crate::one_or_many::one_or_many;
use pyo3::prelude::*;

one_or_many! {
    /// Computes the gradient of a function of the next step's results by its input: x A + y C and x B + y D with the
    /// matrices of `linearize`. In a `Batch` each environment has its own function: arrays have the environments (n) as
    /// first axis. The state does not change.
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
    ///     The gradients by x and by the controls, and a dictionary of those by parameters; of a `Batch`, a row for
    ///     each environment.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or an array has another shape or is not finite.
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
        let (model, envs) = (self.described(), self.envs());
        let lead = envs.as_slice();
        let gradients = Gradients::new(model, &outputs, parameters, memory, [x, y], lead)?;
        self.differentiate(py, &gradients)
    }

    /// Computes the gradient of a function of the states after each of the next T steps. The state does not change. The
    /// memory is that of A and B of each step except the last.
    ///
    /// Parameters
    /// ----------
    /// ctrl : array_like, shape (T, nu) or (T, n, nu) in a Batch
    ///     Controls of each step.
    /// x : array_like, shape (T, 2 nv + na) or (T, n, 2 nv + na) in a Batch
    ///     Gradient by x after each step; see `vjp`.
    /// memory : bool
    ///     True to extend x as in `linearize`.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     The gradients by the first x, shape (2 nv + na,), and by the controls, (T, nu); of a `Batch`, (n, 2 nv + na)
    ///     and (T, n, nu).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an array has another shape or is not finite.
    /// SimulationError
    ///     If `step` of a `Sim` would raise it in any step, or a step of an environment fails.
    #[pyo3(signature = (ctrl, x, *, memory = false), text_signature = "($self, ctrl, x, *, memory=False)")]
    fn rollout_vjp(
        &self,
        py: Python<'_>,
        ctrl: &Bound<'_, PyAny>,
        x: &Bound<'_, PyAny>,
        memory: bool,
    ) -> PyResult<Results> {
        let envs = self.envs();
        let rollouts = Rollouts::of_arrays(self.described(), ctrl, x, memory, envs.as_slice())?;
        self.differentiate(py, &rollouts)
    }
}
