//! Constraints at run time in environments of a batch, each handled by a simulation of that environment.

use super::{Batch, Precision};
use crate::sim::{DynamicConstraint, Sim};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use clench_dynamics::model::ParamField;
use clench_math::Vec3;

impl<S: Precision> Batch<S> {
    /// Welds two bodies in their present relative pose in each of these environments, see [`Sim::add_weld`].
    ///
    /// # Errors
    /// Returns an error as [`Sim::add_weld`] does, or if there is no such environment. No state changes.
    pub fn add_weld(
        &mut self,
        envs: &[usize],
        body1: usize,
        body2: usize,
    ) -> Result<Vec<DynamicConstraint>, SimError> {
        self.change(envs, |_, sim| sim.add_weld(body1, body2))
    }

    /// Connects two points in each of these environments, see [`Sim::add_connect`].
    ///
    /// # Errors
    /// Returns an error as [`Sim::add_connect`] does, or if there is no such environment. No state changes.
    pub fn add_connect(
        &mut self,
        envs: &[usize],
        body1: usize,
        body2: usize,
        anchor: Vec3<S>,
    ) -> Result<Vec<DynamicConstraint>, SimError> {
        self.change(envs, |_, sim| sim.add_connect(body1, body2, anchor))
    }

    /// Removes the k-th of `constraints` from the k-th of `envs`.
    ///
    /// # Errors
    /// Returns an error if a constraint does not exist, if there is no such environment, or if their numbers differ. No
    /// state changes.
    pub fn remove(
        &mut self,
        envs: &[usize],
        constraints: &[DynamicConstraint],
    ) -> Result<(), SimError> {
        clench_dynamics::check::check_length("constraints", constraints.len(), envs.len())?;
        self.change(envs, |k, sim| sim.remove(constraints[k]))
            .map(drop)
    }

    /// Activates a weld or connect of the model at the present pose in each of these environments, see
    /// [`Sim::weld_here`].
    ///
    /// # Errors
    /// Returns an error as [`Sim::weld_here`] does, or if there is no such environment.
    pub fn weld_here(&mut self, envs: &[usize], equality: usize) -> Result<(), SimError> {
        self.check_envs(envs)?;
        for &env in envs {
            let mut sim = self.sim(env)?;
            sim.weld_here(equality)?;
            for field in [
                ParamField::eq_anchor1,
                ParamField::eq_anchor2,
                ParamField::eq_quat1,
            ] {
                self.copy_param(field, &[env], &sim.param(field.name())?)?;
            }
            self.state.write(env, &sim.state)?;
        }
        Ok(())
    }

    /// Returns [`Sim::last_serial`] of each environment.
    pub fn last_serials(&self) -> &[u32] {
        &self.serials
    }

    /// Calls [`Sim::set_last_serial`] for each environment.
    ///
    /// # Errors
    /// Returns an error if the length is wrong.
    pub fn set_last_serials(&mut self, serials: &[u32]) -> Result<(), SimError> {
        check_length("serials", serials.len(), self.serials.len())?;
        self.serials.copy_from_slice(serials);
        Ok(())
    }

    /// Changes the states of these environments one by one, or none of them on failure.
    fn change<R>(
        &mut self,
        envs: &[usize],
        mut act: impl FnMut(usize, &mut Sim<S>) -> Result<R, SimError>,
    ) -> Result<Vec<R>, SimError> {
        self.check_held("dynamic_kind")?;
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
                recorded.invalidate(env);
            }
        }
        Ok(results)
    }
}
