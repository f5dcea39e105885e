//! Judging the steps of a simulation.

use super::Sim;
use crate::Precision;
use crate::batch::{Place, Quality};

impl Quality {
    /// Takes in the last step of a simulation, which must have gone well.
    pub fn note<T: Precision>(&mut self, sim: &Sim<T>) {
        let place = Place {
            model: sim.model(),
            params: sim.params(),
            settings: sim.settings(),
            ws: sim.workspace(),
        };
        self.count(place, 1, true);
    }
}
