//! Batches of several models.

use super::models::Models;
use super::rows::per_env;
use super::{Batch, BatchOptions, Precision};
use crate::sim::Sim;
use clench_builder::SharedLayout;
use clench_dynamics::check::check_length;
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::model::Model;
use std::slice::from_ref;
use std::sync::Arc;

impl<S: Precision> Batch<S> {
    /// Creates environments of several models; environment i has model `env_model[i]`.
    ///
    /// The models have the same bodies, joints, sites, cameras, tendons, actuators, sensors and constraints, with the
    /// same names of joints, actuators and sensors. Their geoms, meshes, height fields and all numbers may
    /// differ. Environments of all models share lanes. Each moves exactly as a [`Sim`] of its own model.
    ///
    /// [`model`](Self::model) is the common layout: each body has the geoms that any model needs there, and
    /// [`geoms_of`](Self::geoms_of) returns those of one model. Parameters and outputs of geoms are in this layout;
    /// [`sim`](Self::sim) returns a simulation of the environment's own model.
    ///
    /// # Errors
    /// Returns an error as [`with_options`](Self::with_options) does, or if an environment has no model, or if models
    /// differ in anything else; it names both models and the element. The option `stiction` needs a single model.
    pub fn of_models(
        models: &[Arc<Model>],
        env_model: &[usize],
        options: BatchOptions,
    ) -> Result<Self, SimError> {
        check_models(env_model, models.len())?;
        if let [model] = models {
            return Batch::with_options(Arc::clone(model), env_model.len(), options);
        }
        let shared = SharedLayout::new(models)?;
        let layout = Arc::clone(shared.layout());
        let mut batch = Batch::with_options(layout, env_model.len(), options)?;
        if batch.settings.stiction {
            return Err(SimError::OneModel("the option stiction"));
        }
        let of_env = env_model.iter().map(|&model| model as u32);
        batch.models = Models::several(shared, of_env.collect());
        (0..batch.count()).try_for_each(|env| batch.reset(env))?;
        Ok(batch)
    }

    /// Creates `count` environments; environment i has model i modulo the number of models.
    ///
    /// # Errors
    /// Returns an error as [`of_models`](Self::of_models) does.
    pub fn of_models_in_turn(
        models: &[Arc<Model>],
        count: usize,
        options: BatchOptions,
    ) -> Result<Self, SimError> {
        if let [model] = models {
            return Batch::with_options(Arc::clone(model), count, options);
        }
        let mut env_model = per_env(count, || 0)?;
        let turns = (0..models.len()).cycle();
        env_model
            .iter_mut()
            .zip(turns)
            .for_each(|(own, turn)| *own = turn);
        Batch::of_models(models, &env_model, options)
    }

    /// Returns the models of the environments.
    pub fn models(&self) -> &[Arc<Model>] {
        match self.models.shared() {
            Some(shared) => shared.models(),
            None => from_ref(&self.model),
        }
    }

    /// Returns the number of the model of environment `env`, an index in [`models`](Self::models).
    ///
    /// # Panics
    /// Panics if the environment does not exist.
    pub fn env_model(&self, env: usize) -> usize {
        assert!(env < self.count(), "there is no environment {env}");
        self.models.of(env)
    }

    /// Returns the index in [`model`](Self::model) of each geom of model `model`.
    ///
    /// # Errors
    /// Returns an error if there is no such model.
    pub fn geoms_of(&self, model: usize) -> Result<Vec<usize>, SimError> {
        check_models(&[model], self.models().len())?;
        Ok(match self.models.shared() {
            Some(shared) => shared.geoms(model).to_vec(),
            None => (0..self.model.geoms.len()).collect(),
        })
    }

    /// Returns the index in the model of environment `env` of a geom of [`model`](Self::model); `None` if the
    /// environment does not have it.
    ///
    /// # Panics
    /// Panics if the environment does not exist.
    pub fn own_geom(&self, env: usize, geom: usize) -> Option<usize> {
        let model = self.env_model(env);
        match self.models.shared() {
            Some(shared) => {
                let mut own = shared.geoms(model).iter();
                own.position(|&place| place == geom)
            }
            None => (geom < self.model.geoms.len()).then_some(geom),
        }
    }

    /// Gives environments models, and resets them: `models[k]` to environment `envs[k]`. Parameters of their own become
    /// those of the models, also where an environment had the model before.
    ///
    /// # Errors
    /// Returns an error if the lengths differ, or if there is no such environment or model. Nothing changes then.
    pub fn reset_to_models(&mut self, envs: &[usize], models: &[usize]) -> Result<(), SimError> {
        check_length("models", models.len(), envs.len())?;
        check_models(models, self.models().len())?;
        self.check_envs(envs)?;
        self.check_state()?;
        for (&env, &model) in envs.iter().zip(models) {
            if self.models.of(env) != model {
                self.models.set(env, model);
            }
            let (shared, rows) = (&self.models, &mut self.params);
            for own in rows {
                let params = shared.params(&self.model, env);
                own.set(env, &params);
            }
            if let Some(recorded) = &mut self.recorded {
                recorded.invalidate(env);
            }
            self.reset(env)?;
        }
        Ok(())
    }

    /// Returns a simulation of the model of environment `env`, if `sim` has another one.
    pub(super) fn other_sim(&self, env: usize, sim: &Sim<S>) -> Result<Option<Sim<S>>, SimError> {
        let own = self.models.own(&self.model, env);
        if !self.models.are_several() || Arc::ptr_eq(own, sim.model()) {
            return Ok(None);
        }
        Sim::with_options(Arc::clone(own), self.options.options).map(Some)
    }
}

/// Checks numbers of models.
fn check_models(numbers: &[usize], count: usize) -> Result<(), SimError> {
    match numbers.iter().find(|&&number| number >= count) {
        Some(&number) => Err(no_such("model", number, count)),
        None => Ok(()),
    }
}
