//! The user-visible data of environments, shared by the threads of a call.

use super::Rows;
use super::shared::Shared;
use super::state_rows::{Inputs, MovingRows};
use clench_dynamics::model::{ParamField, Params};
use clench_math::{Real, Scalar};

pub struct EnvRows<'a, S: Scalar + Shared> {
    pub motion: MovingRows<'a, S>,
    pub inputs: Inputs<'a, S>,
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
    /// Copies the row of an environment into every lane.
    pub fn splat<T: Real<Scalar = S>>(&self, env: usize, params: &mut Params<T>) {
        params.write_lanes(self.field, self.rows.row(env));
    }
    /// Returns the size of a row in bytes.
    pub(crate) fn row_bytes(&self) -> usize {
        self.rows.row_bytes()
    }
}
