//! Operations on individual environments: reset, revive, extract as a simulation.

use super::{Batch, EnvStatus, Precision};
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
        self.state.write(env, self.models.initial(env))?;
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
        let keyframes = &self.models.own(&self.model, env).keyframes;
        let Some(keyframe) = keyframes.get(key) else {
            return Err(no_such("keyframe", key, keyframes.len()));
        };
        self.scratch.copy_from(self.models.initial(env));
        self.scratch.set_keyframe(&self.model, keyframe);
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
        let model = self.models.own(&self.model, env);
        let mut sim = Sim::with_options(Arc::clone(model), self.options.options)?;
        self.copy_to_sim(env, &mut sim)?;
        Ok(sim)
    }

    /// Copies the parameters that environments have of their own to a simulation of the environment's model.
    pub(super) fn copy_params(&self, env: usize, sim: &mut Sim<S>) {
        for own in &self.params {
            let row = self.models.own_row(env, own.field, own.rows.row(env));
            sim.params_mut().write_lanes(own.field, &row);
        }
    }

    /// Copies the state and parameters of environment `env` to a simulation of the same model, so that one simulation
    /// can serve many environments in turn. In a batch of several models, the simulation is replaced if it has another
    /// model than the environment.
    ///
    /// # Errors
    /// Returns an error as [`reset`](Self::reset) does, or if the simulation has another model.
    pub fn copy_to_sim(&self, env: usize, sim: &mut Sim<S>) -> Result<(), SimError> {
        self.check_env(env)?;
        self.check_state()?;
        if let Some(other) = self.other_sim(env, sim)? {
            *sim = other;
        }
        self.state.copy_to(env, &mut sim.state)?;
        self.copy_params(env, sim);
        Ok(())
    }
}
