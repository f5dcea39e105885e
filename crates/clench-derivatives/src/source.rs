//! The input of a step to differentiate.

use crate::request::Request;
use crate::stage::Stage;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::{State, StepContext, StepSettings};
use clench_math::Real;
use clench_rigid::evaluate_sensors;

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

impl<'a> Source<'a> {
    /// Returns the context of passes in dual numbers, which evaluate sensors.
    pub(crate) fn context<T: Real>(&self, params: &'a Params<T>) -> StepContext<'a, T> {
        StepContext {
            model: self.model,
            params,
            settings: self.settings,
            sensors: evaluate_sensors,
        }
    }

    /// Returns the context of passes in plain numbers, which evaluate no sensors.
    pub(crate) fn without_sensors(&self) -> StepContext<'a, f64> {
        StepContext::without_sensors(self.model, self.params, self.settings)
    }
}
