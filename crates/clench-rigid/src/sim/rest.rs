//! Steps in which everything remains asleep.

use super::{Sim, alone};
use crate::Precision;

impl<T: Precision> Sim<T> {
    /// Runs a step if everything is asleep as the last step left it. Returns true if it did; no further check is then
    /// needed.
    pub(super) fn rest(&mut self) -> bool {
        let as_left = self.settings.flags.sleep
            && !self.halfway
            && self.known.holds_everything()
            && self.state.fits(&self.model);
        if !as_left {
            return false;
        }
        let (model, params, settings) = (&self.model, &self.params, &self.settings);
        let ws = &mut self.ws;
        alone::change(&mut self.state, &mut self.room, |state| {
            T::rest(model, params, settings, state, ws)
        })
    }
}
