//! Operations on individual environments: reset, revive, extract as a simulation.

use super::{Batch, EnvStatus, Precision, StateRows};
use crate::sim::Sim;
use clench_dynamics::check::check_length;
use clench_dynamics::error::{SimError, no_such};
use std::sync::Arc;

impl<S: Precision> Batch<S> {
    /// Resets environment `env` to the model's initial state and sets it running.
    ///
    /// # Errors
    /// Returns an error if there is no such environment, or if tables of [`state`](Self::state) have wrong shapes.
    pub fn reset(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.check_state()?;
        self.state.write(env, &self.initial)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// Resets environment `env` to a keyframe of the model and sets it running. Other fields get their initial values.
    ///
    /// # Errors
    /// Returns an error as [`reset`](Self::reset) does, or if there is no such keyframe.
    pub fn reset_to_keyframe(&mut self, env: usize, key: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.check_state()?;
        let Some(keyframe) = self.model.keyframes.get(key) else {
            return Err(no_such("keyframe", key, self.model.keyframes.len()));
        };
        self.scratch.copy_from(&self.initial);
        self.scratch.set_keyframe(keyframe);
        self.state.write(env, &self.scratch)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// Calls [`reset`](Self::reset) for every environment whose `mask` is true.
    ///
    /// # Errors
    /// Returns an error if the mask or tables of `state` have wrong shapes.
    pub fn reset_mask(&mut self, mask: &[bool]) -> Result<(), SimError> {
        check_length("mask", mask.len(), self.count())?;
        let mut masked = (0..self.count()).filter(|&env| mask[env]);
        masked.try_for_each(|env| self.reset(env))
    }

    /// Sets environment `env` running from the state in its rows.
    ///
    /// # Errors
    /// Returns an error if there is no such environment.
    pub fn revive(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// Creates a simulation with the state and parameters of environment `env`.
    ///
    /// # Errors
    /// See [`reset`](Self::reset).
    pub fn sim(&self, env: usize) -> Result<Sim<S>, SimError> {
        let mut sim = Sim::with_options(Arc::clone(&self.model), self.options.options)?;
        self.copy_to_sim(env, &mut sim)?;
        Ok(sim)
    }

    /// Copies the state and parameters of environment `env` to a simulation of the same model, so that one simulation
    /// can serve many environments in turn.
    ///
    /// # Errors
    /// Returns an error as [`reset`](Self::reset) does, or if the simulation has another model.
    pub fn copy_to_sim(&self, env: usize, sim: &mut Sim<S>) -> Result<(), SimError> {
        self.check_env(env)?;
        self.check_state()?;
        let mut row = StateRows::new(&self.model, 1)?;
        row.copy_row(0, &self.state, env);
        row.read(0, &mut sim.state)?;
        for own in &self.params {
            own.splat(env, sim.params_mut());
        }
        Ok(())
    }
}
