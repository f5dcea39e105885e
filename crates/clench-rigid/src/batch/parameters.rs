//! Parameters of individual environments, and options of all.

use super::env_rows::ParamRows;
use super::{Batch, Precision, Rows};
use clench_dynamics::check::check_length;
use clench_dynamics::constants::{CONSTANTS, constants};
use clench_dynamics::error::SimError;
use clench_dynamics::model::{Model, ParamField};
use clench_dynamics::options::RigidOptions;
use clench_dynamics::settings::StepSettings;

impl<S: Precision> Batch<S> {
    /// Assigns values of their own to environments in place of the model's. `field` is the name of a field of
    /// [`Params`](crate::model::Params); `values` are, for each of `envs` in turn, all values of the field, element by
    /// element.
    ///
    /// Dependent fields are updated: `body_subtreemass` from `body_mass`, `geom_rbound` from `geom_size`, the frames of
    /// equalities between sites from `site_pos` and `site_quat`. Quaternions and axes are normalized. All other derived
    /// values stay the model's until [`set_constants`](Self::set_constants). Only fields that were set in some
    /// environment take memory. An environment keeps its values when it is reset or restored.
    ///
    /// # Errors
    /// Returns an error if the name is unknown, if the field is derived from another, if there is no such environment,
    /// if the number of values is wrong, or if a value is invalid. No parameter changes.
    pub fn randomize(&mut self, field: &str, envs: &[usize], values: &[S]) -> Result<(), SimError> {
        let field = ParamField::settable(field)?;
        let values = self.checked(field, envs, values)?;
        self.assign(envs, &[(field, values)])
    }

    /// Assigns a field of every environment as [`randomize`](Self::randomize) does, for a copy of a batch: also a field
    /// that follows from another, after that one. Every bit is retained, also of directions.
    ///
    /// # Errors
    /// Returns an error as [`randomize`](Self::randomize) does.
    pub fn restore_param(&mut self, field: &str, values: &[S]) -> Result<(), SimError> {
        let envs = Vec::from_iter(0..self.count());
        self.copy_param(ParamField::find(field)?, &envs, values)
    }

    /// Assigns a field of environments, with every bit.
    pub(super) fn copy_param(
        &mut self,
        field: ParamField,
        envs: &[usize],
        values: &[S],
    ) -> Result<(), SimError> {
        self.checked(field, envs, values)?;
        self.assign(envs, &[(field, values.to_vec())])
    }

    /// Returns valid values of a field, with normalized directions.
    fn checked(&self, field: ParamField, envs: &[usize], values: &[S]) -> Result<Vec<S>, SimError> {
        self.check_envs(envs)?;
        let width = self.model.params.width(field);
        check_length(field.name(), values.len(), width * envs.len())?;
        let mut values = values.to_vec();
        for (&env, row) in envs.iter().zip(values.chunks_mut(width.max(1))) {
            let mut own = self.models.own_row(env, field, row);
            field.check_row(self.models.own(&self.model, env), &mut own)?;
            self.models.layout_row(env, field, &own, row);
        }
        Ok(values)
    }

    /// Assigns checked values of fields to environments. Operations that may fail precede the first change.
    fn assign(&mut self, envs: &[usize], changes: &[(ParamField, Vec<S>)]) -> Result<(), SimError> {
        let on_device = match &self.mirror {
            Some(mirror) => mirror.parameters(&self.model, &self.params, envs, changes)?,
            None => Vec::new(),
        };
        for &(field, _) in changes {
            self.param_rows(field)?;
            for &follower in field.followers(&self.model) {
                self.param_rows(follower)?;
            }
        }
        for (field, values) in changes {
            self.assign_field(*field, envs, values)?;
        }
        if let Some(recorded) = &mut self.recorded {
            envs.iter().for_each(|&env| recorded.invalidate(env));
        }
        match &mut self.mirror {
            Some(mirror) => mirror.set_parameters(envs, &on_device),
            None => Ok(()),
        }
    }

    /// Assigns a field and its followers on the processor.
    fn assign_field(
        &mut self,
        field: ParamField,
        envs: &[usize],
        values: &[S],
    ) -> Result<(), SimError> {
        let followers = field.followers(&self.model);
        let mut params = (!followers.is_empty()).then(|| self.model.params.broadcast::<S>());
        for (&env, row) in envs.iter().zip(rows_of(&self.model, field, values)) {
            Model::clear_structural_guarantees(&mut self.model, field, row);
            self.param_rows(field)?.row_mut(env).copy_from_slice(row);
            let Some(params) = &mut params else {
                continue;
            };
            for &follower in followers {
                let old = self.param_rows(follower)?.row(env);
                params.write_lane(follower, 0, old);
            }
            params.write_lane(field, 0, row);
            params.derive(&self.model, field);
            for &follower in followers {
                let row = params.read_lane(follower, 0);
                let rows = self.param_rows(follower)?;
                rows.row_mut(env).copy_from_slice(&row);
            }
        }
        Ok(())
    }

    /// Computes the derived parameters of environments in the initial configuration, as
    /// [`Sim::set_constants`](crate::Sim::set_constants) does.
    ///
    /// # Errors
    /// Returns an error if there is no such environment, or if a mass matrix is not positive definite. No parameter
    /// changes.
    pub fn set_constants(&mut self, envs: &[usize]) -> Result<(), SimError> {
        self.check_envs(envs)?;
        let mut params = self.model.params.clone();
        let mut changes = CONSTANTS.map(|field| (field, Vec::new())).to_vec();
        for &env in envs {
            let model = self.models.own(&self.model, env);
            if self.models.are_several() {
                params.clone_from(&model.params);
            }
            for own in &self.params {
                let row = self.models.own_row(env, own.field, own.rows.row(env));
                params.write_of_simulation(own.field, &row, &model.params);
            }
            let rows = constants::<S>(model, &mut params);
            let rows = rows.map_err(|singular| singular.error(model, Some(env)))?;
            for ((field, values), own) in changes.iter_mut().zip(rows) {
                let mut row = self.param(field.name(), env)?;
                self.models.layout_row(env, *field, &own, &mut row);
                values.extend(row);
            }
        }
        changes.retain(|(field, values)| self.differs(*field, envs, values));
        if changes.is_empty() {
            return Ok(());
        }
        self.assign(envs, &changes)
    }

    /// Returns true if environments have other values of a field.
    fn differs(&self, field: ParamField, envs: &[usize], values: &[S]) -> bool {
        let own = self.params.iter().find(|own| own.field == field);
        let mut rows = envs.iter().zip(rows_of(&self.model, field, values));
        rows.any(|(&env, row)| match own {
            Some(own) => own.rows.row(env) != row,
            None => self.model_row(env, field) != row,
        })
    }

    /// Returns a parameter field, by name, of environment `env`.
    ///
    /// # Errors
    /// Returns an error if the name is unknown, or if there is no such environment.
    pub fn param(&self, field: &str, env: usize) -> Result<Vec<S>, SimError> {
        let field = ParamField::find(field)?;
        self.check_env(env)?;
        let own = self.params.iter().find(|own| own.field == field);
        Ok(match own {
            Some(own) => own.rows.row(env).to_vec(),
            None => self.model_row(env, field),
        })
    }

    /// Replaces the options that override those of the model, for subsequent steps.
    ///
    /// # Errors
    /// Returns an error if an option is out of range or belongs to the creation of the batch, or if a collision that is
    /// possible is not supported. The options are then unchanged.
    pub fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        self.check_changeable("the options")?;
        let settings = StepSettings::supported::<S>(&self.model, options)?;
        settings.check_stick_references(&self.model)?;
        self.settings = settings;
        self.options.options = options;
        if let Some(recorded) = &mut self.recorded {
            (0..self.status.len()).for_each(|env| recorded.invalidate(env));
        }
        Ok(())
    }

    /// Returns the values of a field of an environment's model.
    fn model_row(&self, env: usize, field: ParamField) -> Vec<S> {
        let numbers = match self.models.are_several() {
            true => self.models.params(&self.model, env).read_lane(field, 0),
            false => self.model.params.read_lane(field, 0),
        };
        numbers.into_iter().map(S::new).collect()
    }

    /// Returns the rows of a field. New rows contain the model's values.
    fn param_rows(&mut self, field: ParamField) -> Result<&mut Rows<S>, SimError> {
        let index = match self.params.iter().position(|own| own.field == field) {
            Some(index) => index,
            None => {
                let row = self.model_row(0, field);
                let rows = Rows::repeat(self.count(), &row, S::ZERO)?;
                let mut own = ParamRows { field, rows };
                if self.models.are_several() {
                    for env in 0..self.count() {
                        own.set(env, &self.models.params(&self.model, env));
                    }
                }
                self.params.push(own);
                self.params.len() - 1
            }
        };
        Ok(&mut self.params[index].rows)
    }
}

/// Splits the values of a field into rows, one for each environment.
fn rows_of<'a, S>(model: &Model, field: ParamField, values: &'a [S]) -> std::slice::Chunks<'a, S> {
    values.chunks(model.params.width(field).max(1))
}
