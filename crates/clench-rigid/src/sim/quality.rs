//! Quality statistics of a simulation's steps.

use super::Sim;
use crate::Precision;
use crate::batch::{Quality, StepResults};
use clench_math::Mask;

impl Quality {
    /// Adds the last step of a simulation, which must have succeeded.
    pub fn add_step<T: Precision>(&mut self, sim: &Sim<T>) {
        let results = StepResults {
            model: sim.model(),
            params: sim.params(),
            settings: sim.settings(),
            ws: sim.workspace(),
        };
        self.count(results, 1, Mask::splat(true));
    }
}
