//! What `Sim` answers about forces and accelerations.

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

/// Which acceleration is given, by the argument or else by the model.
pub(crate) fn given(model: &Model, discrete: Option<bool>) -> Acceleration {
    match discrete {
        None => Acceleration::of(model),
        Some(true) => Acceleration::Discrete,
        Some(false) => Acceleration::Continuous,
    }
}

#[pymethods]
impl Sim {
    /// M x: the forces along dofs that accelerations take, as MuJoCo's ``mj_mulM``. See `mass_matrix` for M itself.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Accelerations (nv,), or rows of them (k, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     In the shape of `x`.
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

    /// M⁻¹ x: the accelerations that forces along dofs cause, as MuJoCo's ``mj_solveM``.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Forces (nv,), or rows of them (k, nv).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     In the shape of `x`.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     A mass matrix that is singular.
    fn solve_mass<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            each_row("x", x, nv, |row| sim.solve_mass(row))
        })
    }

    /// The forces along dofs of a force and a torque on a body, as MuJoCo's ``mj_applyFT``.
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
    ///     Where the force acts, in the world (3,), m; by default at the body's centre of mass.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (nv,), N along slides and N m about hinges. Nothing is applied: add it to `qfrc_applied` for that.
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
                let place = match point {
                    Some(point) => point,
                    None => Vec3::from_slice(&sim.output("xipos")?[3 * body..]),
                };
                sim.add_joint_forces(body, place, wrench, &mut qfrc)
            });
            done.map_err(sim_error)?;
            answer(py, qfrc, &[model.nv], None)
        })
    }

    /// Inverse dynamics: the forces along dofs that cause an acceleration in the present state, contacts and all other constraints
    /// included, as MuJoCo's ``mj_inverse``.
    ///
    /// It is what actuators and applied forces have to add up to: ``qfrc_actuator + qfrc_applied`` and what ``xfrc_applied`` is
    /// along dofs. Nothing is searched for. Outputs stay as they are; whatever sleeps takes part.
    ///
    /// Parameters
    /// ----------
    /// qacc : array_like
    ///     Accelerations (nv,), or rows of them (k, nv).
    /// discrete : bool, optional
    ///     Whether they are those by which a step changes the velocity, ``(v1 - v0) / timestep``; else those that `forward` finds.
    ///     They differ where forces are integrated implicitly. By default as the model says (flag ``invdiscrete``).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Forces, N and N m, in the shape of `qacc`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Wrong shapes, numbers that are not finite, discrete ones with the Runge-Kutta integrator.
    /// SimulationError
    ///     As `step`.
    #[pyo3(signature = (qacc, *, discrete = None))]
    fn inverse<'py>(
        &self,
        qacc: &Bound<'py, PyAny>,
        discrete: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let given = given(model, discrete);
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            let mut forces = vec![Real::ZERO; model.nv];
            each_row("qacc", qacc, model.nv, |row| {
                sim.inverse(row, given, &mut forces)?;
                row.copy_from_slice(&forces);
                Ok(())
            })
        })
    }
}
