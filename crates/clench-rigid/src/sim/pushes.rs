//! What constraints push on, asked of a simulation.

use super::Sim;
use crate::Precision;
use crate::error::SimError;
use crate::output::Source;
use crate::readout::{self, Push};

impl<T: Precision> Sim<T> {
    /// What constraints but contacts pushed on in the last step or forward; what is not known is computed, as
    /// [`refresh`](Self::refresh) says.
    ///
    /// # Errors
    /// A state as [`step`](Self::step) refuses it.
    pub fn pushes(&mut self) -> Result<Vec<Push>, SimError> {
        self.refresh()?;
        let source = Source {
            model: &self.model,
            params: &self.params,
            state: &self.state,
            ws: &mut self.ws,
        };
        Ok(readout::pushes(&source, 0))
    }
}
