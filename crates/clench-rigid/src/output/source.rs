//! The data that outputs are read from.

use clench_dynamics::model::{Model, Params};
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::Real;

/// The data that outputs are read from.
#[doc(hidden)]
#[derive(Debug)]
pub struct Source<'a, T: Real> {
    pub model: &'a Model,
    pub params: &'a Params<T>,
    pub state: &'a State<T>,
    pub ws: &'a mut Workspace<T>,
}
