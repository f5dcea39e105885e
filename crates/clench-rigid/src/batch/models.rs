//! The models of a batch, and the model of each environment.

use super::{Batch, BatchOptions, Precision};
use crate::sim::Sim;
use clench_builder::{ParamRange, SharedLayout};
use clench_dynamics::check::check_length;
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::model::{Model, ParamField, Params};
use clench_dynamics::state::State;
use clench_math::{Real, Scalar};
use std::slice::from_ref;
use std::sync::Arc;

/// The models of a batch.
pub struct Models<S: Scalar> {
    /// The common layout of several models.
    shared: Option<SharedLayout>,
    /// The numbers in which the models differ, and these numbers of each model.
    ranges: Vec<ParamRange>,
    rows: Vec<Vec<S>>,
    /// The initial state of each model.
    initial: Vec<State<S>>,
    /// The model of each environment; empty if there is one model.
    of_env: Vec<u32>,
    /// True if models have different meshes, which are searched one after the other: environments of one model are then
    /// grouped.
    differ_in_meshes: bool,
}

impl<S: Scalar> Models<S> {
    /// Creates the table of a single model.
    pub(super) fn one(model: &Model) -> Self {
        Models {
            shared: None,
            ranges: Vec::new(),
            rows: Vec::new(),
            initial: vec![State::new(model)],
            of_env: Vec::new(),
            differ_in_meshes: false,
        }
    }

    /// Creates the table of several models.
    fn several(shared: SharedLayout, of_env: Vec<u32>) -> Self {
        let (ranges, rows) = shared.differences();
        let rows = rows.into_iter();
        let models = shared.models().iter();
        Models {
            ranges,
            rows: rows
                .map(|row| row.into_iter().map(S::new).collect())
                .collect(),
            initial: models.map(|model| State::new(model)).collect(),
            of_env,
            differ_in_meshes: shared.differ_in_assets(),
            shared: Some(shared),
        }
    }

    /// Returns the number of the model of an environment.
    #[inline(always)]
    pub(super) fn of(&self, env: usize) -> usize {
        self.of_env.get(env).map_or(0, |&model| model as usize)
    }

    /// Returns the numbers by which environments are grouped before their contacts.
    pub(super) fn groups(&self) -> Option<&[u32]> {
        self.differ_in_meshes.then_some(&self.of_env)
    }

    /// Returns true if environments have different models.
    pub(super) fn are_several(&self) -> bool {
        self.shared.is_some()
    }

    /// Returns the initial state of an environment.
    pub(super) fn initial(&self, env: usize) -> &State<S> {
        &self.initial[self.of(env)]
    }

    /// Copies the numbers of an environment's model that other models do not have into lane `lane`.
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, params: &mut Params<T>) {
        let model = self.of(env);
        params.lane_models.resize(T::LANES, 0);
        params.lane_models[lane] = model as u32;
        let mut row = &self.rows[model][..];
        for ParamRange { field, numbers } in &self.ranges {
            let (part, rest) = row.split_at(numbers.len());
            params.write_part(*field, lane, numbers.start, part);
            row = rest;
        }
    }

    /// Returns the parameters of an environment's model, in the layout.
    pub(super) fn params(&self, layout: &Model, env: usize) -> Params<f64> {
        match &self.shared {
            Some(shared) => shared.params(self.of(env)),
            None => layout.params.clone(),
        }
    }

    /// Returns the model of an environment as its author gave it.
    pub(super) fn own<'a>(&'a self, layout: &'a Arc<Model>, env: usize) -> &'a Arc<Model> {
        match &self.shared {
            Some(shared) => &shared.models()[self.of(env)],
            None => layout,
        }
    }

    /// Returns a row of a field in the layout as one of the environment's own model.
    pub(super) fn own_row(&self, env: usize, field: ParamField, row: &[S]) -> Vec<S> {
        match &self.shared {
            Some(shared) => shared.own_row(self.of(env), field, row),
            None => row.to_vec(),
        }
    }

    /// Returns a row of a field of the environment's own model in the layout; `row` has the numbers of other geoms.
    pub(super) fn layout_row(&self, env: usize, field: ParamField, own: &[S], row: &mut [S]) {
        match &self.shared {
            Some(shared) => shared.write_own_row(self.of(env), field, own, row),
            None => row.copy_from_slice(own),
        }
    }
}

impl<S: Precision> Batch<S> {
    /// Creates environments of several models; environment i has model `env_model[i]`.
    ///
    /// The models have the same bodies, joints, sites, cameras, tendons, actuators, sensors and constraints, with the
    /// same names of joints, actuators and sensors. Their geoms, meshes and height fields differ as they like, and so
    /// do all numbers. Environments of all models share lanes. Each moves exactly as a [`Sim`] of its own model.
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

    /// Returns the models of the environments.
    pub fn models(&self) -> &[Arc<Model>] {
        match &self.models.shared {
            Some(shared) => shared.models(),
            None => from_ref(&self.model),
        }
    }

    /// Returns the number of the model of environment `env`, an index in [`models`](Self::models).
    pub fn env_model(&self, env: usize) -> usize {
        self.models.of(env)
    }

    /// Returns the index in [`model`](Self::model) of each geom of model `model`.
    ///
    /// # Errors
    /// Returns an error if there is no such model.
    pub fn geoms_of(&self, model: usize) -> Result<Vec<usize>, SimError> {
        check_models(&[model], self.models().len())?;
        Ok(match &self.models.shared {
            Some(shared) => shared.geoms(model).to_vec(),
            None => (0..self.model.geoms.len()).collect(),
        })
    }

    /// Gives environments other models, and resets them: `models[k]` to environment `envs[k]`. Parameters of their own
    /// become those of the models.
    ///
    /// # Errors
    /// Returns an error if the lengths differ, or if there is no such environment or model. Nothing changes then.
    pub fn reset_to_models(&mut self, envs: &[usize], models: &[usize]) -> Result<(), SimError> {
        check_length("models", models.len(), envs.len())?;
        check_models(models, self.models().len())?;
        self.check_envs(envs)?;
        self.check_state()?;
        for (&env, &model) in envs.iter().zip(models) {
            let changes = self.models.of(env) != model;
            if changes {
                self.models.of_env[env] = model as u32;
                let (shared, rows) = (&self.models, &mut self.params);
                for own in rows {
                    let params = shared.params(&self.model, env);
                    own.set(env, &params);
                }
                if let Some(recorded) = &mut self.recorded {
                    recorded.invalidate(env);
                }
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
