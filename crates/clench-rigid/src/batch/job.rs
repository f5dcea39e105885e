//! The input and the reports of the threads of a call.

use super::answer::QueryCall;
use super::divergence::Divergence;
use super::env_rows::EnvRows;
use super::quality::Quality;
use super::recorded_states::RecordedStateCells;
use super::shared::Shared;
use super::targets::{Controls, Targets};
use clench_dynamics::error::Fault;
use clench_dynamics::model::Model;
use clench_dynamics::profile::Profile;
use clench_dynamics::settings::StepSettings;
use clench_math::Scalar;
use std::ops::Range;
use std::sync::atomic::AtomicU64;

/// A call of a batch: steps or a forward pass of its running environments.
#[derive(Clone)]
pub(super) struct Call<'a, S> {
    pub(super) pass: Pass,
    /// The steps of the call that are done now.
    pub(super) range: Range<usize>,
    /// The total number of steps.
    pub(super) steps: usize,
    pub(super) controls: Controls<'a, S>,
    /// The environments that take part; all that run if `None`.
    pub(super) mask: Option<&'a [bool]>,
}

impl<S> Call<'_, S> {
    /// Creates a call of `steps` steps, with the controls in the state.
    pub(super) fn steps(steps: usize) -> Self {
        Call {
            pass: Pass::Step,
            range: 0..steps,
            steps,
            controls: Controls::Held,
            mask: None,
        }
    }
}

impl<'a, S> Call<'a, S> {
    /// Creates a forward pass of the environments in a mask, or of all.
    pub(super) fn forward(pass: Pass, mask: Option<&'a [bool]>) -> Self {
        Call {
            pass,
            mask,
            ..Call::steps(1)
        }
    }
}

/// The input of the threads of a call, the same for every group.
pub struct Job<'a, S: Scalar + Shared> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub rows: EnvRows<'a, S>,
    /// The sort key of each environment, which places environments with similar contacts next to each other.
    pub(crate) sort_keys: &'a [AtomicU64],
    /// The computation.
    pub pass: Pass,
    /// The states of recorded outputs, if there are any.
    pub recorded: Option<RecordedStateCells<'a, S>>,
    /// The destinations of outputs.
    pub targets: Targets<'a, S>,
    pub controls: Controls<'a, S>,
    /// The steps from `first` to `end` of all steps of the call are done now.
    pub first: usize,
    pub end: usize,
    pub steps: usize,
}

/// The computation of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// Advances the states.
    Step,
    /// Computes the results of the states without changing them.
    Forward,
    /// The same for a query: nothing fails and nothing is counted.
    Query,
}

/// The report of a stepper.
#[derive(Default)]
pub struct StepTotals {
    /// Environments that failed, with their faults.
    pub faults: Vec<(u32, Fault)>,
    /// Environments that were reset to the initial state.
    pub resets: Vec<u32>,
    pub divergence: Divergence,
    pub quality: Quality,
}

/// A thread's scratch memory in lanes of a fixed width.
pub trait Stepper<S: Scalar + Shared>: Send {
    /// Returns its number of environments.
    fn lanes(&self) -> usize;
    /// Runs a job for a group of at most [`lanes`](Self::lanes) environments.
    fn run(&mut self, group: &[u32], job: &Job<S>);
    /// Answers a query of such a group.
    fn query(&mut self, group: &[u32], call: &QueryCall<S>);
    /// Returns the events since it was last cleared.
    fn totals(&mut self) -> &mut StepTotals;
    /// Starts or stops its clocks.
    fn run_clocks(&mut self, running: bool);
    /// Returns the time spent in each stage while they ran.
    fn profile(&mut self) -> Profile;
}
