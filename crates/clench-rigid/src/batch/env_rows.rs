//! What users see of environments, as the threads of a call share it.

use super::Rows;
use super::shared::Shared;
use super::state_rows::{Inputs, MovingRows};
use clench_dynamics::model::{ParamField, Params};
use clench_math::{Real, Scalar};

/// What users see of environments.
pub struct EnvRows<'a, S: Scalar + Shared> {
    pub motion: MovingRows<'a, S>,
    pub inputs: Inputs<'a, S>,
    /// Parameters that environments have for themselves.
    pub params: &'a [ParamRows<S>],
}

/// A field of the parameters, a row an environment.
pub struct ParamRows<S> {
    pub(super) field: ParamField,
    pub(super) rows: Rows<S>,
}

impl<S: Scalar + Shared> ParamRows<S> {
    /// Copies the row of an environment into lane `lane`.
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, params: &mut Params<T>) {
        params.write_lane(self.field, lane, self.rows.row(env));
    }
    /// Copies the row of an environment into every lane.
    pub fn splat<T: Real<Scalar = S>>(&self, env: usize, params: &mut Params<T>) {
        params.write_lanes(self.field, self.rows.row(env));
    }
    /// Bytes that a row takes.
    pub(crate) fn row_bytes(&self) -> usize {
        self.rows.row_bytes()
    }
}
