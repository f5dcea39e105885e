//! What a batch asks of a device that steps its environments in memory of its own, such as a graphics card: fields of the state
//! go up, steps are done there, states and outputs come down. `on_device.rs` keeps both sides alike.

use crate::output::Output;
use clench_dynamics::error::SimError;
use clench_dynamics::model::Model;

/// A device that steps all environments of a batch in memory of its own.
///
/// Fields of the state and outputs go by their names and in the forms of [`StateRows`](super::StateRows) and [`Output`], row after
/// row; truth values are 0 and 1. Its errors are [`SimError::Backend`]: they say what the device cannot do, or that it failed.
pub trait Backend<S>: Send {
    /// Its name.
    fn name(&self) -> String;
    /// Bytes that an environment takes on it.
    fn bytes_per_env(&self) -> usize;
    /// Whether it holds a field of the state. Those that it does not hold stay what they are in the initial state; but for `start_time`, the
    /// time of each environment when what it is told to do next begins (s), which it need not know.
    fn holds(&self, field: &str) -> bool;
    /// Whether it computes an output that does not lie in the state.
    fn computes(&self, output: Output) -> bool;
    /// Computes these outputs from now on, besides those that it was asked for before.
    ///
    /// # Errors
    /// What of the model it cannot compute them of; that the device failed.
    fn want(&mut self, outputs: &[Output]) -> Result<(), SimError>;
    /// The parameters of a model, which differs from that of the batch in its parameters alone, as the device takes them.
    ///
    /// # Errors
    /// Parameters that the device cannot have for an environment alone.
    fn parameters_of(&self, model: &Model) -> Result<Vec<S>, SimError>;
    /// Gives these environments such parameters in place of the model's.
    ///
    /// # Errors
    /// That the device has no room for them, or failed.
    fn set_parameters(&mut self, envs: &[usize], rows: &[Vec<S>]) -> Result<(), SimError>;
    /// Replaces a field of the state of all environments.
    ///
    /// # Errors
    /// That the device failed.
    fn write(&mut self, field: &'static str, rows: &[S]) -> Result<(), SimError>;
    /// Copies a field of the state of all environments into `rows`.
    ///
    /// # Errors
    /// That the device failed.
    fn read(&mut self, field: &'static str, rows: &mut [S]) -> Result<(), SimError>;
    /// Copies an output that it computes into `rows`, as the last forward pass left it.
    ///
    /// # Errors
    /// That the device failed.
    fn read_output(&mut self, output: Output, rows: &mut [S]) -> Result<(), SimError>;
    /// Advances the environments that are `running` by `steps` time steps, and tells of each what became of it. One that fails
    /// keeps its last good state and goes no further; of those that do not run nothing changes.
    ///
    /// # Errors
    /// That the device failed.
    fn step(
        &mut self,
        steps: usize,
        running: &[bool],
        outcomes: &mut [Outcome],
    ) -> Result<(), SimError>;
    /// Computes what follows from the states of those that are `running`, and leaves the states alone.
    ///
    /// # Errors
    /// That the device failed.
    fn forward(&mut self, running: &[bool], outcomes: &mut [Outcome]) -> Result<(), SimError>;
}

/// What became of an environment in a call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// How many steps it did.
    pub steps: usize,
    /// Why it did not do the next.
    pub trouble: Option<Trouble>,
}

/// Why a step could not be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// The mass matrix is not positive definite.
    Singular,
    /// A number is not finite, or beyond 1e10.
    Diverged {
        /// Which quantity.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// What it became.
        value: f64,
    },
    /// More contacts than there may be.
    ContactOverflow {
        /// How many that is.
        limit: usize,
    },
    /// The device ended a loop before its end.
    Unfinished,
}
