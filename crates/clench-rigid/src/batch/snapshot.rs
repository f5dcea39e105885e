//! Snapshots of environments.

use super::{Batch, EnvStatus, Precision, StateRows};
use clench_dynamics::error::SimError;

/// The states and statuses of some environments of a batch.
#[derive(Debug)]
pub struct Snapshot<S> {
    state: StateRows<S>,
    status: Vec<EnvStatus>,
    envs: Vec<usize>,
}

impl<S: Precision> Snapshot<S> {
    /// Returns the saved environments, in the order of the rows.
    pub fn envs(&self) -> &[usize] {
        &self.envs
    }
    /// Returns their states.
    pub fn state(&self) -> &StateRows<S> {
        &self.state
    }
}

impl<S: Precision> Batch<S> {
    /// Saves the states of all environments. A restored environment continues bit for bit as the original, as long as
    /// its parameters are the same.
    ///
    /// # Errors
    /// See [`save_envs`](Self::save_envs).
    pub fn save(&self) -> Result<Snapshot<S>, SimError> {
        self.save_envs(&Vec::from_iter(0..self.count()))
    }

    /// Saves the states of these environments.
    ///
    /// # Errors
    /// Returns an error if there is no such environment, if tables of [`state`](Self::state) have wrong shapes, or if
    /// memory is insufficient.
    pub fn save_envs(&self, envs: &[usize]) -> Result<Snapshot<S>, SimError> {
        self.check_envs(envs)?;
        self.check_state()?;
        let mut state = StateRows::new(self.model(), envs.len())?;
        for (row, &env) in envs.iter().enumerate() {
            state.copy_row(row, &self.state, env);
        }
        Ok(Snapshot {
            state,
            status: envs.iter().map(|&env| self.status[env].clone()).collect(),
            envs: envs.to_vec(),
        })
    }

    /// Restores the environments of a snapshot.
    ///
    /// # Errors
    /// Returns an error if the snapshot has states of other sizes or belongs to a larger batch, or if tables of
    /// [`state`](Self::state) have wrong shapes.
    pub fn restore(&mut self, snapshot: &Snapshot<S>) -> Result<(), SimError> {
        self.restore_to(snapshot, &snapshot.envs)
    }

    /// Assigns the k-th state of a snapshot to environment `envs[k]`.
    ///
    /// # Errors
    /// Returns an error as [`restore`](Self::restore) does, or if the number of environments is wrong.
    pub fn restore_to(&mut self, snapshot: &Snapshot<S>, envs: &[usize]) -> Result<(), SimError> {
        self.check_envs(envs)?;
        self.check_state()?;
        snapshot.state.check_shapes(self.model(), envs.len())?;
        for (row, &env) in envs.iter().enumerate() {
            self.state.copy_row(env, &snapshot.state, row);
            self.status[env] = snapshot.status[row].clone();
        }
        Ok(())
    }
}
