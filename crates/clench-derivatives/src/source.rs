//! The input of a step to differentiate.

use crate::request::Request;
use crate::stage::Stage;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::{State, StepSettings};

/// The input of a step.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub params: &'a Params<f64>,
    pub state: &'a State<f64>,
    pub request: &'a Request,
    /// True in the first pass from a state.
    pub first: bool,
    /// The first stage whose results change along the directions.
    pub start: Stage,
    /// True if the factor of the mass matrix needs no derivatives.
    pub constant_factor: bool,
}
