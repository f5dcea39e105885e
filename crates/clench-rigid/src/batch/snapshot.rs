//! Saving and restoring environments.

use super::{Batch, EnvStatus, Precision, StateRows};
use clench_dynamics::error::SimError;

/// The states of some environments of a batch, and whether they run.
#[derive(Debug)]
pub struct Snapshot<S> {
    state: StateRows<S>,
    status: Vec<EnvStatus>,
    envs: Vec<usize>,
}

impl<S: Precision> Snapshot<S> {
    /// Which environments were saved, in the order of the rows.
    pub fn envs(&self) -> &[usize] {
        &self.envs
    }
    /// Their states.
    pub fn state(&self) -> &StateRows<S> {
        &self.state
    }
}

impl<S: Precision> Batch<S> {
    /// Saves the states of all environments: what is restored moves on as it would have, to the bit, as long as its
    /// parameters are the same.
    ///
    /// # Errors
    /// As [`save_envs`](Self::save_envs).
    pub fn save(&self) -> Result<Snapshot<S>, SimError> {
        self.save_envs(&Vec::from_iter(0..self.count()))
    }

    /// Saves the states of these environments.
    ///
    /// # Errors
    /// Environments that the batch does not have; tables of [`state`](Self::state) that are not those of this batch; more
    /// memory than there is.
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

    /// Brings the environments of a snapshot back to what they were.
    ///
    /// # Errors
    /// A snapshot of states of other sizes or of a larger batch; tables of [`state`](Self::state) that are not those of this
    /// batch.
    pub fn restore(&mut self, snapshot: &Snapshot<S>) -> Result<(), SimError> {
        self.restore_to(snapshot, &snapshot.envs)
    }

    /// Gives environment `envs[k]` the k-th state of a snapshot.
    ///
    /// # Errors
    /// As [`restore`](Self::restore), and another number of environments than were saved.
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
