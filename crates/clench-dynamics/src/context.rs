//! The inputs of a step that it does not change.

use crate::model::{Model, Params};
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::Real;

/// The inputs of a step or pass beside the state.
#[derive(Clone, Copy, Debug)]
pub struct StepContext<'a, T: Real> {
    /// The model.
    pub model: &'a Model,
    /// Its parameters, which may differ between lanes.
    pub params: &'a Params<T>,
    /// The settings of the solver and of the model's options.
    pub settings: &'a StepSettings,
    /// Evaluates the sensors.
    pub sensors: Sensors<T>,
}

impl<'a, T: Real> StepContext<'a, T> {
    /// Creates a context whose passes evaluate no sensors.
    pub fn without_sensors(
        model: &'a Model,
        params: &'a Params<T>,
        settings: &'a StepSettings,
    ) -> Self {
        StepContext {
            model,
            params,
            settings,
            sensors: |_, _, _| (),
        }
    }
}

/// A function that evaluates the sensors of a model, after a forward pass and before the state advances. This crate has
/// no sensors.
pub type Sensors<T> = fn(StepContext<T>, &State<T>, &mut Workspace<T>);
