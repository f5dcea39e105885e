//! Constraints at run time in environments of a batch: each as a simulation of that environment does it.

use super::{Batch, Precision};
use crate::sim::{DynamicConstraint, Sim};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use clench_math::Vec3;

impl<S: Precision> Batch<S> {
    /// Holds two bodies together as they lie now in each of these environments, see [`Sim::add_weld`].
    ///
    /// # Errors
    /// As [`Sim::add_weld`], and environments that the batch does not have. All states are then as before.
    pub fn add_weld(
        &mut self,
        envs: &[usize],
        body1: usize,
        body2: usize,
    ) -> Result<Vec<DynamicConstraint>, SimError> {
        self.change(envs, |_, sim| sim.add_weld(body1, body2))
    }

    /// Holds two points together in each of these environments, see [`Sim::add_connect`].
    ///
    /// # Errors
    /// As [`Sim::add_connect`], and environments that the batch does not have. All states are then as before.
    pub fn add_connect(
        &mut self,
        envs: &[usize],
        body1: usize,
        body2: usize,
        anchor: Vec3<S>,
    ) -> Result<Vec<DynamicConstraint>, SimError> {
        self.change(envs, |_, sim| sim.add_connect(body1, body2, anchor))
    }

    /// Lets go of a constraint in each of these environments, the k-th of `constraints` in the k-th of `envs`.
    ///
    /// # Errors
    /// Constraints that are not there, environments that the batch does not have, or another number of them. All states are
    /// then as before.
    pub fn remove(
        &mut self,
        envs: &[usize],
        constraints: &[DynamicConstraint],
    ) -> Result<(), SimError> {
        clench_dynamics::check::check_length("constraints", constraints.len(), envs.len())?;
        self.change(envs, |k, sim| sim.remove(constraints[k]))
            .map(drop)
    }

    /// Lets a weld or connect of the model hold its bodies as they lie now in each of these environments, see [`Sim::weld_here`].
    ///
    /// # Errors
    /// As [`Sim::weld_here`], and environments that the batch does not have.
    pub fn weld_here(&mut self, envs: &[usize], equality: usize) -> Result<(), SimError> {
        self.check_envs(envs)?;
        for &env in envs {
            let mut sim = self.sim(env)?;
            sim.weld_here(equality)?;
            for field in ["eq_anchor1", "eq_anchor2", "eq_quat1"] {
                self.randomize(field, &[env], &sim.param(field)?)?;
            }
            self.state.write(env, &sim.state)?;
        }
        Ok(())
    }

    /// For each environment the serial number of the last constraint that was added at run time, as [`Sim::last_serial`].
    pub fn last_serials(&self) -> &[u32] {
        &self.serials
    }

    /// As [`Sim::set_last_serial`], for each environment.
    ///
    /// # Errors
    /// Another number of them than of environments.
    pub fn set_last_serials(&mut self, serials: &[u32]) -> Result<(), SimError> {
        check_length("serials", serials.len(), self.serials.len())?;
        self.serials.copy_from_slice(serials);
        Ok(())
    }

    /// Changes the states of environments one by one, or none of them.
    fn change<R>(
        &mut self,
        envs: &[usize],
        mut act: impl FnMut(usize, &mut Sim<S>) -> Result<R, SimError>,
    ) -> Result<Vec<R>, SimError> {
        self.check_changeable("the constraints")?;
        self.check_envs(envs)?;
        let Some(&first) = envs.first() else {
            return Ok(Vec::new());
        };
        let mut sim = self.sim(first)?;
        let (mut results, mut before) = (Vec::new(), Vec::new());
        for (k, &env) in envs.iter().enumerate() {
            self.copy_to_sim(env, &mut sim)?;
            sim.last_serial = self.serials[env];
            before.push((env, sim.state.clone()));
            match act(k, &mut sim) {
                Ok(result) => results.push(result),
                Err(error) => {
                    for (env, state) in before.iter().rev() {
                        self.state.write(*env, state)?;
                    }
                    return Err(error);
                }
            }
            self.state.write(env, &sim.state)?;
            self.serials[env] = sim.last_serial;
            if let Some(recorded) = &mut self.recorded {
                recorded.forget(env);
            }
        }
        Ok(results)
    }
}
