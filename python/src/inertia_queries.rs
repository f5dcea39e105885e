//! Queries of `Sim` and `Batch` about forces and accelerations.

use crate::answer::answer;
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::one_or_many::one_or_many;
use crate::queries::vector;
use crate::row_sim::{AnySim, each_sim};
use crate::sim::Sim;
use crate::target::Choice;
use clench::math::{Real, Vec3};
use clench::{Acceleration, Query};
use pyo3::prelude::*;

one_or_many! {
    /// Computes M x, the forces along dofs that cause given accelerations, like MuJoCo's ``mj_mulM``. `mass_matrix`
    /// returns M itself. A `Sim` uses the poses that queries use (see `Sim`), a `Batch` the current states.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Accelerations (nv,), or rows of them (k, nv). In a `Batch`, one row for all environments, or (n, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The forces, N and N m, in the shape of `x`; of a `Batch` (n, nv), NaN where a state is not finite.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    /// SimulationError
    ///     If the state of a `Sim` is not finite.
    fn mul_mass<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.replace(py, Query::MulMass, ("x", x))
    }

    /// Computes M⁻¹ x, the accelerations caused by forces along dofs, like MuJoCo's ``mj_solveM``.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Forces (nv,), or rows of them (k, nv). In a `Batch`, one row for all environments, or (n, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The accelerations, in the shape of `x`; of a `Batch` (n, nv), NaN where a state is not finite or a mass
    ///     matrix is singular.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    /// SimulationError
    ///     If the mass matrix of a `Sim` is singular.
    fn solve_mass<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.replace(py, Query::SolveMass, ("x", x))
    }

    /// Computes inverse dynamics: the forces along dofs that cause an acceleration in the current state, contacts and
    /// all other constraints included, like MuJoCo's ``mj_inverse``.
    ///
    /// This is the required sum of actuator and applied forces: ``qfrc_actuator + qfrc_applied`` and ``xfrc_applied``
    /// mapped to dofs. The computation is direct, without iterations. Outputs do not change; sleeping trees are
    /// included.
    ///
    /// Parameters
    /// ----------
    /// qacc : array_like
    ///     Accelerations (nv,), or rows of them (k, nv). In a `Batch`, one row for all environments, or (n, nv).
    /// discrete : bool, optional
    ///     True if a step changes the velocity by them, ``(v1 - v0) / timestep``; false if they are those that
    ///     `forward` finds. They differ if forces are integrated implicitly. The default is the model's flag
    ///     ``invdiscrete``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Forces, N and N m, in the shape of `qacc`; of a `Batch` (n, nv), NaN where a single `Sim` would raise
    ///     SimulationError.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong, a number is not finite, or `discrete` is used with the Runge-Kutta integrator.
    /// SimulationError
    ///     As for `step` of a `Sim`.
    #[pyo3(signature = (qacc, *, discrete = None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        qacc: &Bound<'py, PyAny>,
        discrete: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let kind = match discrete {
            None => Acceleration::of(self.described()),
            Some(true) => Acceleration::Discrete,
            Some(false) => Acceleration::Continuous,
        };
        self.replace(py, Query::Inverse(kind), ("qacc", qacc))
    }
}

#[pymethods]
impl Sim {
    /// Computes the forces along dofs of a force and a torque on a body, like MuJoCo's ``mj_applyFT``.
    ///
    /// Parameters
    /// ----------
    /// body : str or int
    ///     The body.
    /// force : array_like, optional
    ///     N, world axes (3,).
    /// torque : array_like, optional
    ///     N m, world axes (3,).
    /// point : array_like, optional
    ///     The point of application in the world (3,), m; by default the body's centre of mass.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (nv,), N along slides and N m about hinges. To apply them, add them to `qfrc_applied`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the name, or a vector has another shape or is not finite.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (body, force = None, torque = None, point = None))]
    fn joint_forces<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        force: Choice<'_, 'py>,
        torque: Choice<'_, 'py>,
        point: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let body = Kind::Body.find(model, body)?;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let part = |name: &str, value: Choice| value.map_or(Ok(Vec3::ZERO), |v| vector(name, v));
            let wrench = (part("force", force)?, part("torque", torque)?);
            let point = point.map(|point| vector("point", point)).transpose()?;
            let mut qfrc = vec![Real::ZERO; model.nv];
            let done = own.current().and_then(|sim| {
                let position = match point {
                    Some(point) => point,
                    None => Vec3::from_slice(&sim.output("xipos")?[3 * body..]),
                };
                sim.add_joint_forces(body, position, wrench, &mut qfrc)
            });
            done.map_err(sim_error)?;
            answer(py, qfrc, &[model.nv], None)
        })
    }
}
