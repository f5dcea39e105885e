//! Steps in two halves, for controllers that need quantities that depend on the positions and velocities of the step.

use super::Sim;
use crate::Precision;
use crate::validity::Computed;
use clench_dynamics::Step;
use clench_dynamics::error::SimError;
use clench_dynamics::profile::Stage;

impl<T: Precision> Sim<T> {
    /// Runs the first half of a step: everything that depends only on positions and velocities, which can then be read.
    /// Other results, such as accelerations and contact forces, are those of the previous step.
    ///
    /// # Errors
    /// See [`step`](Self::step).
    pub fn step1(&mut self) -> Result<(), SimError> {
        self.with_autoreset(Self::try_step1)
    }

    fn try_step1(&mut self) -> Result<(), SimError> {
        self.check_state()?;
        self.on_threads(|context, state, ws| {
            (Step::compiled().before_forces)(context, state, ws);
        });
        self.validity.record(Computed::Positions, &self.state);
        self.halfway = true;
        Ok(())
    }

    /// Runs the second half of a step, with the present controls and applied forces. After [`step1`](Self::step1), both
    /// halves together equal a [`step`](Self::step) bit for bit. If anything but controls and forces was written in
    /// between, or [`step1`](Self::step1) was not called, it runs the whole step.
    ///
    /// # Errors
    /// See [`step`](Self::step).
    pub fn step2(&mut self) -> Result<(), SimError> {
        let begun = self.halfway && self.validity.computed(&self.state) == Computed::Positions;
        let valid = self.validity.same_velocities(&self.state) && self.check_state().is_ok();
        if !begun || !valid || self.settings.flags.sleep {
            return self.step();
        }
        self.halfway = false;
        self.last_good.copy_moving_from(&self.state);
        self.on_threads(Step::compiled().step_from_forces);
        let result = self.check_result(self.last_good.time);
        self.record_validity(&result);
        if result.is_ok() {
            self.ws.clock.lap(Stage::Rows as usize);
            return result;
        }
        self.state.copy_moving_from(&self.last_good);
        if self.settings.autoreset {
            // The step fails again and is handled by `autoreset`.
            return self.step();
        }
        result
    }

    /// Runs a step. After the results of positions and velocities are computed, `control` reads the simulation and
    /// writes `state.ctrl` or applied forces.
    ///
    /// # Errors
    /// See [`step`](Self::step); also the errors of `control`.
    pub fn step_with(
        &mut self,
        control: impl FnOnce(&mut Self) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        self.step1()?;
        control(self)?;
        self.step2()
    }
}
