//! What constraints push on, asked of a simulation.

use super::Sim;
use crate::Precision;
use crate::error::SimError;
use crate::readout::Push;

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
}
