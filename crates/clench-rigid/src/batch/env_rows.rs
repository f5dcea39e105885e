//! The user-visible data of environments, shared by the threads of a call.

use super::Rows;
use super::models::Models;
use super::shared::Shared;
use super::state_rows::{Inputs, MovingRows};
use clench_dynamics::model::{ParamField, Params};
use clench_math::{Real, Scalar};

pub struct EnvRows<'a, S: Scalar + Shared> {
    pub motion: MovingRows<'a, S>,
    pub inputs: Inputs<'a, S>,
    /// The models of the environments.
    pub models: &'a Models<S>,
    /// Parameters of individual environments.
    pub params: &'a [ParamRows<S>],
}

/// A field of the parameters, one row per environment.
pub struct ParamRows<S> {
    pub(super) field: ParamField,
    pub(super) rows: Rows<S>,
}

impl<S: Scalar + Shared> ParamRows<S> {
    /// Copies the row of an environment into lane `lane`.
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, params: &mut Params<T>) {
        params.write_lane(self.field, lane, self.rows.row(env));
    }
    /// Copies the row of an environment in double precision.
    pub(super) fn read_f64(&self, env: usize, params: &mut Params<f64>) {
        let row = self.rows.row(env).iter().map(|x| x.to_f64());
        params.write_lane(self.field, 0, &Vec::from_iter(row));
    }
    /// Replaces the row of an environment by the numbers of a model.
    pub(super) fn set(&mut self, env: usize, params: &Params<f64>) {
        let row = params.read_lane(self.field, 0);
        let row = row.into_iter().map(S::new);
        self.rows
            .row_mut(env)
            .iter_mut()
            .zip(row)
            .for_each(|(to, x)| *to = x);
    }
    /// Returns the size of a row in bytes.
    pub(crate) fn row_bytes(&self) -> usize {
        self.rows.row_bytes()
    }
}
