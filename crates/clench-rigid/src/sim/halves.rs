//! Steps in two halves, for controllers that need what depends on positions and velocities of the step that they control.

use super::Sim;
use crate::Precision;
use crate::known::Extent;
use clench_dynamics::error::SimError;
use clench_dynamics::profile::Stage;

impl<T: Precision> Sim<T> {
    /// The first half of a step: all that depends on positions and velocities alone, which can then be read. What follows from controls
    /// too, such as accelerations and forces of contacts, is that of the step before.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step1(&mut self) -> Result<(), SimError> {
        self.check_present()?;
        self.on_threads(|model, params, settings, state, ws| {
            T::before_forces(model, params, settings, state, ws);
        });
        self.known.note(Extent::Positions, &self.state);
        self.halfway = true;
        Ok(())
    }

    /// The second half of a step, with the controls and applied forces that are set by now. After [`step1`](Self::step1), both together
    /// are a [`step`](Self::step), to the bit; where positions, velocities or anything but controls and forces were written in between,
    /// or nothing was begun, the whole step is done here.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step2(&mut self) -> Result<(), SimError> {
        let begun = self.halfway && self.known.extent(&self.state) == Extent::Positions;
        if !begun || !self.known.same_velocities(&self.state) || self.settings.flags.sleep {
            return self.step();
        }
        self.halfway = false;
        self.check_present()?;
        self.last_good.copy_moving_from(&self.state);
        self.on_threads(T::step_from_forces);
        let result = self.check_result(self.last_good.time);
        self.note(&result);
        if result.is_ok() {
            self.ws.clock.lap(Stage::Rows as usize);
            return result;
        }
        self.state.copy_moving_from(&self.last_good);
        if self.settings.autoreset {
            // It fails once more, and starts over as the options say.
            return self.step();
        }
        result
    }

    /// A step whose controls `control` sets, when positions and velocities of the step are known: it reads what it needs of the
    /// simulation and writes `state.ctrl`, or applied forces.
    ///
    /// # Errors
    /// As [`step`](Self::step), and those of `control`.
    pub fn step_with(
        &mut self,
        control: impl FnOnce(&mut Self) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        self.step1()?;
        control(self)?;
        self.step2()
    }
}
