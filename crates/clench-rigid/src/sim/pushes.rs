//! Constraint forces and tendon paths of a simulation.

use super::Sim;
use crate::Precision;
use crate::readout::{Push, TendonLine};
use clench_dynamics::error::SimError;

impl<T: Precision> Sim<T> {
    /// Returns the forces of constraints other than contacts in the last step or forward pass. Stale results are
    /// refreshed.
    ///
    /// # Errors
    /// Returns an error if [`step`](Self::step) would refuse the state.
    pub fn pushes(&mut self) -> Result<Vec<Push>, SimError> {
        self.refresh()?;
        Ok(self.read(|source| T::pushes(source)))
    }

    /// Returns the straight segments of all spatial tendons from the last step, forward pass or
    /// [`refresh`](Self::refresh). An arc around a geom is replaced by its chord.
    pub fn tendon_lines(&self) -> Vec<TendonLine> {
        T::tendon_lines(&self.model, &self.params, &self.ws)
    }
}
