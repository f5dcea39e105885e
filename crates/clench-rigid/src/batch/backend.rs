//! The interface to a device that steps the environments of a batch in its own memory, such as a GPU. State fields are
//! uploaded, states and outputs downloaded. `on_device.rs` keeps host and device consistent.

use crate::output::Output;
use clench_dynamics::contact::Excess;
use clench_dynamics::error::SimError;
use clench_dynamics::model::Model;

/// A device that steps all environments of a batch in its own memory.
///
/// Fields of the state and outputs have the names and layouts of [`StateRows`](super::StateRows) and [`Output`], row by
/// row; Boolean values are 0 and 1. Errors are [`SimError::Backend`]: they report an unsupported feature or a device
/// failure.
pub trait Backend<S>: Send {
    /// Returns its name.
    fn name(&self) -> String;
    /// Returns the bytes per environment on the device.
    fn bytes_per_env(&self) -> usize;
    /// Returns true if the device has this field of the state. Other fields keep their initial values. The exception is
    /// `start_time`, the time of each environment at the start of the next command (s), which is optional.
    fn holds(&self, field: &str) -> bool;
    /// Returns true if it computes this output, which is not in the state.
    fn computes(&self, output: Output) -> bool;
    /// Computes these outputs from now on, in addition to those requested before.
    ///
    /// # Errors
    /// Returns an error if the device cannot compute them for this model, or if it failed.
    fn request(&mut self, outputs: &[Output]) -> Result<(), SimError>;
    /// Returns the device's parameters for a model that differs from the batch's only in parameters.
    ///
    /// # Errors
    /// Returns an error if the device does not support the parameter per environment.
    fn parameters_of(&self, model: &Model) -> Result<Vec<S>, SimError>;
    /// Assigns parameters in that form to these environments in place of the model's.
    ///
    /// # Errors
    /// Returns an error if the device runs out of memory or failed.
    fn set_parameters(&mut self, envs: &[usize], rows: &[Vec<S>]) -> Result<(), SimError>;
    /// Replaces a field of the state of all environments.
    ///
    /// # Errors
    /// Returns an error if the device failed.
    fn write(&mut self, field: &'static str, rows: &[S]) -> Result<(), SimError>;
    /// Copies a field of the state of all environments into `rows`.
    ///
    /// # Errors
    /// Returns an error if the device failed.
    fn read(&mut self, field: &'static str, rows: &mut [S]) -> Result<(), SimError>;
    /// Copies an output of the last forward pass into `rows`.
    ///
    /// # Errors
    /// Returns an error if the device failed.
    fn read_output(&mut self, output: Output, rows: &mut [S]) -> Result<(), SimError>;
    /// Advances the environments that are `running` by `steps` time steps, and reports their outcomes. An environment
    /// that fails keeps its last good state and stops. With the option `autoreset` it first repeats the step from the
    /// initial state, as a [`Batch`](super::Batch) does; this state includes the controls unless `keeps_controls`.
    /// Environments that do not run do not change.
    ///
    /// # Errors
    /// Returns an error if the device failed.
    fn step(
        &mut self,
        steps: usize,
        keeps_controls: bool,
        running: &[bool],
        outcomes: &mut [Outcome],
    ) -> Result<(), SimError>;
    /// Computes the results of the states that are `running`, without changing the states.
    ///
    /// # Errors
    /// Returns an error if the device failed.
    fn forward(&mut self, running: &[bool], outcomes: &mut [Outcome]) -> Result<(), SimError>;
}

/// The outcome of a call for an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The number of completed steps, since the last automatic reset if there was one.
    pub steps: usize,
    /// The number of automatic resets after which a step succeeded.
    pub resets: usize,
    /// True if the state was reset, even if the next step failed too.
    pub restarted: bool,
    /// The failure that prevented the next step.
    pub failure: Option<StepFailure>,
}

/// The reason why a step failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepFailure {
    /// The mass matrix is not positive definite.
    Singular,
    /// A value is not finite, or beyond 1e10.
    Diverged {
        /// The name of the quantity.
        field: &'static str,
        /// The index in it.
        index: usize,
        /// The value.
        value: f64,
    },
    /// There are more contacts than allowed.
    ContactOverflow {
        /// The maximum number of contacts.
        limit: usize,
    },
    /// A quantity exceeds its budget.
    OverBudget(Excess),
    /// The device terminated a loop early.
    Unfinished,
}
