//! All that outputs are read from.

use crate::model::{Model, Params};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::Real;

/// All that outputs are read from.
pub struct Source<'a, T: Real> {
    pub model: &'a Model,
    pub params: &'a Params<T>,
    pub state: &'a State<T>,
    pub ws: &'a mut Workspace<T>,
}
