//! The device's copy of the rows on the host, and its outputs and parameters.

use super::backend::{Backend, Outcome};
use super::env_rows::ParamRows;
use crate::output::Output;
use crate::precision::Precision;
use crate::sim::Sim;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{Model, ParamField};
use clench_dynamics::state::FIELDS;

/// A device, and its copy of the rows on the host.
pub(super) struct Mirror<S: Precision> {
    pub(super) backend: Box<dyn Backend<S>>,
    /// Each field of [`FIELDS`] as last uploaded or downloaded.
    pub(super) fields: Vec<Vec<S>>,
    /// True for environments that take part in a call and still run.
    pub(super) running: Vec<bool>,
    /// True for environments that begin a call in the initial state, because theirs is invalid.
    pub(super) restarted: Vec<bool>,
    pub(super) outcomes: Vec<Outcome>,
    /// Memory for a field or an output.
    pub(super) numbers: Vec<S>,
    /// A simulation for the state of one environment after the other, created when energies are recorded.
    pub(super) sim: Option<Box<Sim<S>>>,
}

impl<S: Precision> Mirror<S> {
    /// Returns the bytes per environment on host and device.
    pub(super) fn bytes_per_env(&self, model: &Model) -> usize {
        let numbers: usize = FIELDS.iter().map(|field| field.numbers(model)).sum();
        let besides = 2 * size_of::<bool>() + size_of::<Outcome>();
        self.backend.bytes_per_env() + numbers * size_of::<S>() + besides
    }

    pub(super) fn name(&self) -> String {
        self.backend.name()
    }

    /// Returns an error if the device does not hold a field of the state.
    pub(super) fn check_held(&self, field: &str) -> Result<(), SimError> {
        if self.backend.holds(field) {
            return Ok(());
        }
        Err(SimError::Backend(format!(
            "{} does not support {field} yet, but an environment has a value of it",
            self.name(),
        )))
    }

    /// Lets the device compute these outputs from now on, except those that follow from the rows. Returns an error if
    /// it cannot.
    pub(super) fn request(&mut self, outputs: &[Output]) -> Result<(), SimError> {
        let from_rows = |output: &Output| output.is_state() || *output == Output::energy;
        let is_available = |output: &Output| from_rows(output) || self.backend.computes(*output);
        let Some(missing) = outputs.iter().find(|output| !is_available(output)) else {
            return self.backend.request(outputs);
        };
        let available = Output::ALL.iter().filter(|output| is_available(output));
        let available = Vec::from_iter(available.map(|output| output.name()));
        Err(SimError::Backend(format!(
            "{} does not compute {} yet; it computes {}",
            self.name(),
            missing.name(),
            available.join(", ")
        )))
    }
}

impl<S: Precision> Mirror<S> {
    /// Returns the device's parameters of environments after `changes`: the values of fields, for each of `envs` in
    /// turn.
    ///
    /// # Errors
    /// Returns an error if the device does not support a parameter per environment.
    pub(super) fn parameters(
        &self,
        model: &Model,
        own: &[ParamRows<S>],
        envs: &[usize],
        changes: &[(ParamField, Vec<S>)],
    ) -> Result<Vec<Vec<S>>, SimError> {
        let mut changed = model.clone();
        let one = |(index, &env): (usize, &usize)| {
            let params = &mut changed.params;
            params.clone_from(&model.params);
            for other in own {
                other.read_f64(env, params);
            }
            for (field, values) in changes {
                let width = params.width(*field);
                let row = values[width * index..][..width].iter().map(|x| x.to_f64());
                params.write_lane(*field, 0, &Vec::from_iter(row));
                params.derive(model, *field);
            }
            self.backend.parameters_of(&changed)
        };
        envs.iter().enumerate().map(one).collect()
    }

    /// Assigns parameters from [`parameters`](Self::parameters) to environments.
    pub(super) fn set_parameters(
        &mut self,
        envs: &[usize],
        rows: &[Vec<S>],
    ) -> Result<(), SimError> {
        self.backend.set_parameters(envs, rows)
    }
}
