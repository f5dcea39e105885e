//! What constraints push on, and where tendons run, asked of a simulation.

use super::Sim;
use crate::Precision;
use crate::readout::{Push, TendonLine};
use clench_dynamics::error::SimError;

impl<T: Precision> Sim<T> {
    /// What constraints but contacts pushed on in the last step or forward; what is not known is computed, as
    /// [`refresh`](Self::refresh) says.
    ///
    /// # Errors
    /// A state as [`step`](Self::step) refuses it.
    pub fn pushes(&mut self) -> Result<Vec<Push>, SimError> {
        self.refresh()?;
        Ok(self.read(|source| T::pushes(source)))
    }

    /// The straight parts of all spatial tendons where they were computed last, by a step, forward pass or [`refresh`](Self::refresh). Where
    /// a string lies on a geom, a chord stands for its arc.
    pub fn tendon_lines(&self) -> Vec<TendonLine> {
        T::tendon_lines(&self.model, &self.params, &self.ws)
    }
}
