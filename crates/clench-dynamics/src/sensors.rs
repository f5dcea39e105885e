//! The function that evaluates sensors within a step.

use crate::model::{Model, Params};
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;

/// A function that evaluates the sensors of a model, after a forward pass and before the state advances. This crate has
/// no sensors.
pub type Sensors<T> = fn(&Model, &Params<T>, &StepSettings, &State<T>, &mut Workspace<T>);
