//! Checks of a state before a step, and of the results after it.

use super::Sim;
use crate::Precision;
use clench_dynamics::check;
use clench_dynamics::error::SimError;

impl<T: Precision> Sim<T> {
    /// Checks that a step can start from the state.
    ///
    /// # Errors
    /// Returns an error if the state has wrong lengths or values.
    pub fn check_state(&self) -> Result<(), SimError> {
        self.check_threads()?;
        check::check_lengths(&self.model, &self.state)?;
        if T::good_inputs(&self.state) {
            return Ok(());
        }
        Err(check::input_fault(&self.model, &self.state, 0).into())
    }

    /// Returns the fault in the results of a step from `time`, if there is one.
    pub(super) fn check_result(&self, time: f64) -> Result<(), SimError> {
        if T::good_results(&self.state, &self.ws) {
            return Ok(());
        }
        Err(check::result_fault(&self.model, time, &self.state, &self.ws, 0).into())
    }
}
