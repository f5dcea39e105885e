//! Directional derivatives of a step: methods of `Sim` and `Batch`.

use crate::changes::Results;
use crate::one_or_many::one_or_many;
use crate::tangents::Tangents;
use pyo3::prelude::*;

one_or_many! {
    /// Computes the directional derivative of the next step: A dx + B du and C dx + D du of `linearize`, without the
    /// matrices, at the cost of one of the passes that compute them. In a `Batch` each environment has its own change:
    /// arrays have the environments (n) as first axis.
    ///
    /// Parameters
    /// ----------
    /// x : array_like, shape (2 nv + na,) or (2 nv + na, k), optional
    ///     Change of x: motion of the positions along the dofs, then changes of the velocities and the activations.
    ///     With k columns, all are computed together, in one pass up to 8 or 16 of them.
    /// u : array_like, shape (nu,) or (nu, k), optional
    ///     Change of the controls.
    /// parameters : mapping of str to array_like, optional
    ///     Changes of parameters (see `clench.PARAMETERS`) or inputs, as in `linearize`: of all numbers of the
    ///     flattened field, or with k columns.
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y; see `clench.OUTPUTS`.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     The change of the next x, shape (2 nv + na,), and that of y; or both with k columns. Of a `Batch` they have
    ///     the environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or an array has another shape or is not finite.
    /// SimulationError
    ///     If `step` of a `Sim` would raise it, or the step of an environment fails.
    ///
    /// Examples
    /// --------
    /// >>> import clench
    /// >>> sim = clench.Sim(clench.Model.from_xml(
    /// ...     "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/>"
    /// ...     "<geom size='0.1' mass='2'/></body></worldbody></mujoco>"))
    /// >>> sim.jvp([0, 1])[0].tolist()
    /// [0.01, 1.0]
    #[pyo3(signature = (x = None, u = None, parameters = None, outputs = Vec::new()),
           text_signature = "($self, x=None, u=None, parameters=None, outputs=())")]
    fn jvp(
        &self,
        py: Python<'_>,
        x: Option<&Bound<'_, PyAny>>,
        u: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyAny>>,
        outputs: Vec<String>,
    ) -> PyResult<Results> {
        let (changes, envs) = ([x, u, parameters], self.envs());
        let tangents = Tangents::new(self.described(), &outputs, changes, envs.as_slice())?;
        self.differentiate(py, &tangents)
    }
}
