//! Queries of `Sim` about forces and accelerations.

use crate::answer::{answer, each_row};
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::vector;
use crate::row_sim::{AnySim, each_sim};
use crate::sim::Sim;
use crate::target::Choice;
use clench::math::{Real, Vec3};
use clench::{Acceleration, Model};
use pyo3::prelude::*;

/// Returns the kind of acceleration: that of the argument, or by default the model's.
pub(crate) fn acceleration_kind(model: &Model, discrete: Option<bool>) -> Acceleration {
    match discrete {
        None => Acceleration::of(model),
        Some(true) => Acceleration::Discrete,
        Some(false) => Acceleration::Continuous,
    }
}

#[pymethods]
impl Sim {
    /// Computes M x, the forces along dofs that cause given accelerations, like MuJoCo's ``mj_mulM``. `mass_matrix`
    /// returns M itself.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Accelerations (nv,), or rows of them (k, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The forces, in the shape of `x`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    /// SimulationError
    ///     If the state is not finite.
    fn mul_mass<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            let mut product = vec![Real::ZERO; nv];
            each_row("x", x, nv, |row| {
                sim.mul_mass(row, &mut product)?;
                row.copy_from_slice(&product);
                Ok(())
            })
        })
    }

    /// Computes M⁻¹ x, the accelerations caused by forces along dofs, like MuJoCo's ``mj_solveM``.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Forces (nv,), or rows of them (k, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The accelerations, in the shape of `x`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    /// SimulationError
    ///     If the mass matrix is singular.
    fn solve_mass<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            each_row("x", x, nv, |row| sim.solve_mass(row))
        })
    }

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
    ///     Accelerations (nv,), or rows of them (k, nv).
    /// discrete : bool, optional
    ///     True if a step changes the velocity by them, ``(v1 - v0) / timestep``; false if they are those that
    ///     `forward` finds. They differ if forces are integrated implicitly. The default is the model's flag
    ///     ``invdiscrete``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Forces, N and N m, in the shape of `qacc`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong, a number is not finite, or `discrete` is used with the Runge-Kutta integrator.
    /// SimulationError
    ///     As for `step`.
    #[pyo3(signature = (qacc, *, discrete = None))]
    fn inverse<'py>(
        &self,
        qacc: &Bound<'py, PyAny>,
        discrete: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let kind = acceleration_kind(model, discrete);
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            let mut forces = vec![Real::ZERO; model.nv];
            each_row("qacc", qacc, model.nv, |row| {
                sim.inverse(row, kind, &mut forces)?;
                row.copy_from_slice(&forces);
                Ok(())
            })
        })
    }
}
