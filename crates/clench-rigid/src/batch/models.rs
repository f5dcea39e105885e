//! The models of a batch, and the model of each environment.

use clench_builder::{ParamRange, SharedLayout};
use clench_dynamics::model::{Model, ParamField, Params};
use clench_dynamics::state::State;
use clench_math::{Real, Scalar};
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
    /// True if environments of one model are grouped.
    grouped: bool,
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
            grouped: false,
        }
    }

    /// Creates the table of several models.
    pub(super) fn several(shared: SharedLayout, of_env: Vec<u32>) -> Self {
        let (ranges, rows) = shared.differences();
        let rows = rows.into_iter();
        let grouped = shared.prefers_groups(&ranges);
        let models = shared.models().iter();
        Models {
            ranges,
            rows: rows
                .map(|row| row.into_iter().map(S::new).collect())
                .collect(),
            initial: models.map(|model| State::new(model)).collect(),
            of_env,
            grouped,
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
        self.grouped.then_some(&self.of_env)
    }

    /// Returns the common layout of several models.
    pub(super) fn shared(&self) -> Option<&SharedLayout> {
        self.shared.as_ref()
    }

    /// Returns true if a model has all of some geoms of the layout.
    pub(super) fn have(&self, model: usize, geoms: &[usize]) -> bool {
        match &self.shared {
            Some(shared) => (geoms.iter()).all(|geom| shared.geoms(model).contains(geom)),
            None => true,
        }
    }

    /// Gives an environment one of several models.
    pub(super) fn set(&mut self, env: usize, model: usize) {
        self.of_env[env] = model as u32;
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
