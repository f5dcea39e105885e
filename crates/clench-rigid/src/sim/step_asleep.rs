//! Steps in which everything remains asleep.

use super::{Sim, computed_state};
use crate::Precision;
use clench_dynamics::Step;

impl<T: Precision> Sim<T> {
    /// Runs a step if everything is asleep as the last step left it. Returns true if it did; no further check is then
    /// needed.
    pub(super) fn step_asleep(&mut self) -> bool {
        let is_unchanged = self.settings.flags.sleep
            && !self.halfway
            && self.validity.is_complete()
            && self.state.fits(&self.model);
        if !is_unchanged {
            return false;
        }
        let context = T::context(&self.model, &self.params, &self.settings);
        let ws = &mut self.ws;
        computed_state::change(&mut self.state, &mut self.lane_copy, |state| {
            (Step::compiled().step_asleep)(context, state, ws)
        })
    }
}
