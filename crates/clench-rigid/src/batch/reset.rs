//! Environments one by one: reset, revived, taken out as a simulation.

use super::{Batch, EnvStatus, Precision, StateRows};
use crate::sim::Sim;
use clench_dynamics::check::check_length;
use clench_dynamics::error::{SimError, no_such};
use std::sync::Arc;

impl<S: Precision> Batch<S> {
    /// Environment `env` back to the model's initial state, running.
    ///
    /// # Errors
    /// An environment that the batch does not have; tables of [`state`](Self::state) that are not those of this batch.
    pub fn reset(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.check_state()?;
        self.state.write(env, &self.initial)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// Environment `env` to a keyframe of the model, running; what a keyframe does not hold is as in the initial state.
    ///
    /// # Errors
    /// As [`reset`](Self::reset), and a keyframe that the model does not have.
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

    /// As [`reset`](Self::reset), for every environment where `mask` is true.
    ///
    /// # Errors
    /// A mask of another length than there are environments; tables as for [`reset`](Self::reset).
    pub fn reset_mask(&mut self, mask: &[bool]) -> Result<(), SimError> {
        check_length("mask", mask.len(), self.count())?;
        let mut masked = (0..self.count()).filter(|&env| mask[env]);
        masked.try_for_each(|env| self.reset(env))
    }

    /// Lets environment `env` run on from the state in its rows.
    ///
    /// # Errors
    /// An environment that the batch does not have.
    pub fn revive(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// A simulation of one environment, in the state and with the parameters of `env`.
    ///
    /// # Errors
    /// As [`reset`](Self::reset).
    pub fn sim(&self, env: usize) -> Result<Sim<S>, SimError> {
        let mut sim = Sim::with_options(Arc::clone(&self.model), self.options.options)?;
        self.copy_to_sim(env, &mut sim)?;
        Ok(sim)
    }

    /// Brings a simulation of the same model into the state and to the parameters of `env`: so one simulation can be asked about
    /// many environments, one after the other.
    ///
    /// # Errors
    /// As [`reset`](Self::reset), and a simulation of another model.
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
