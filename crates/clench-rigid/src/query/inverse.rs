//! Inverse dynamics of a simulation.

use super::checks::check_acceleration;
use super::table::Query;
use crate::Precision;
use crate::sim::Sim;
use clench_dynamics::check::{check_length, check_values};
use clench_dynamics::error::SimError;
use clench_dynamics::inverse::Acceleration;

impl<T: Precision> Sim<T> {
    /// Writes to `qfrc_inverse` (nv) the forces along dofs that cause the acceleration `qacc` (nv) in the present
    /// state, in addition to contacts and all other constraints: the required sum of actuator and applied forces
    /// (MuJoCo's `mj_inverse`). It needs no iterative solve, and earlier results do not change. Sleeping trees are
    /// included.
    ///
    /// Forward dynamics with these forces yield the same acceleration up to the convergence of the solver, unless the
    /// solve ends with `noslip`.
    ///
    /// # Errors
    /// Returns an error if a length is wrong, a value is not finite, the mass matrix is singular, or
    /// [`Acceleration::Discrete`] is combined with the Runge–Kutta integrator, which has no acceleration of its own; or
    /// as [`refresh`](Self::refresh) does.
    pub fn inverse(
        &mut self,
        qacc: &[T],
        kind: Acceleration,
        qfrc_inverse: &mut [T],
    ) -> Result<(), SimError> {
        check_values("qacc", qacc, self.model().nv)?;
        check_length("qfrc_inverse", qfrc_inverse.len(), qacc.len())?;
        check_acceleration(self.model(), kind)?;
        self.write_answer(Query::Inverse(kind), qacc, qfrc_inverse)
    }
}
