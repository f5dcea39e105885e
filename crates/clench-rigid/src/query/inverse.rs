//! Inverse dynamics of a simulation.

use crate::sim::Sim;
use crate::{Model, Precision};
use clench_dynamics::check::{check_length, check_values};
use clench_dynamics::error::SimError;
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::Integrator;

/// An acceleration of this kind, of which inverse dynamics know what to make.
pub(crate) fn check_acceleration(model: &Model, given: Acceleration) -> Result<(), SimError> {
    let stages = model.integrator == Integrator::Rk4;
    match given {
        Acceleration::Discrete if stages => Err(SimError::NoDiscreteInverse),
        _ => Ok(()),
    }
}

impl<T: Precision> Sim<T> {
    /// Writes to `qfrc_inverse` (nv) the forces along dofs that cause the acceleration `qacc` (nv) in the present state, contacts
    /// and all other constraints included: what actuators and applied forces have to add up to (MuJoCo's `mj_inverse`). Nothing
    /// is searched for, and what was computed before stays as it is. Whatever sleeps takes part.
    ///
    /// Forward dynamics with these forces find the same acceleration, as exactly as their solver converges; after a solve that
    /// ends in `noslip` they do not.
    ///
    /// # Errors
    /// Wrong lengths, numbers that are not finite, a mass matrix that is singular, [`Acceleration::Discrete`] with the integrator
    /// of Runge and Kutta, which has no acceleration of its own; else as [`refresh`](Self::refresh).
    pub fn inverse(
        &mut self,
        qacc: &[T],
        given: Acceleration,
        qfrc_inverse: &mut [T],
    ) -> Result<(), SimError> {
        check_values("qacc", qacc, self.model().nv)?;
        check_length("qfrc_inverse", qfrc_inverse.len(), qacc.len())?;
        check_acceleration(self.model(), given)?;
        self.invert(qacc, given, qfrc_inverse)
    }
}
