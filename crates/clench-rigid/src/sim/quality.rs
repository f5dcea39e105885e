//! Judging the steps of a simulation.

use super::Sim;
use crate::Precision;
use crate::batch::{Quality, StepResults};
use clench_math::Mask;

impl Quality {
    /// Takes in the last step of a simulation, which must have gone well.
    pub fn note<T: Precision>(&mut self, sim: &Sim<T>) {
        let results = StepResults {
            model: sim.model(),
            params: sim.params(),
            settings: sim.settings(),
            ws: sim.workspace(),
        };
        self.count(results, 1, Mask::splat(true));
    }
}
