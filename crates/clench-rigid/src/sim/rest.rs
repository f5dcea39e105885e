//! Steps in which everything sleeps as before.

use super::Sim;
use crate::Precision;

impl<T: Precision> Sim<T> {
    /// Does a step that finds everything asleep as the last one left it. Whether it was one: nothing has to be checked then.
    pub(super) fn rest(&mut self) -> bool {
        let as_left = self.settings.flags.sleep
            && !self.halfway
            && self.known.holds_everything()
            && self.state.fits(&self.model);
        as_left
            && T::rest(
                &self.model,
                &self.params,
                &self.settings,
                &mut self.state,
                &mut self.ws,
            )
    }
}
