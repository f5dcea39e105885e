//! Steps in which everything sleeps as before.

use super::{Sim, alone};
use crate::Precision;

impl<T: Precision> Sim<T> {
    /// Does a step that finds everything asleep as the last one left it. Whether it was one: nothing has to be checked then.
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
