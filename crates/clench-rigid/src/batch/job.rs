//! What a call asks of its threads, and what they report.

use super::answer::Asking;
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

/// A call of a batch: steps, or a forward pass, of its running environments.
#[derive(Clone)]
pub(super) struct Call<'a, S> {
    pub(super) pass: Pass,
    /// Which of all its steps are done now.
    pub(super) range: Range<usize>,
    /// How many steps it has.
    pub(super) steps: usize,
    pub(super) controls: Controls<'a, S>,
    /// Which environments take part, if not all that run.
    pub(super) mask: Option<&'a [bool]>,
}

impl<S> Call<'_, S> {
    /// A call of `steps` steps, with the controls that are in the state.
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
    /// One forward pass of the environments in a mask, or of all.
    pub(super) fn forward(pass: Pass, mask: Option<&'a [bool]>) -> Self {
        Call {
            pass,
            mask,
            ..Call::steps(1)
        }
    }
}

/// What a call asks of its threads, the same for every group.
pub struct Job<'a, S: Scalar + Shared> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub rows: EnvRows<'a, S>,
    /// Where each environment stands in an order that puts those of like contacts side by side.
    pub(crate) sort_keys: &'a [AtomicU64],
    /// What is done.
    pub pass: Pass,
    /// For which states outputs hold, where any are kept.
    pub recorded: Option<RecordedStateCells<'a, S>>,
    /// Where outputs go.
    pub targets: Targets<'a, S>,
    pub controls: Controls<'a, S>,
    /// Of all steps of the call, those from `first` to `end` are done now.
    pub first: usize,
    pub end: usize,
    pub steps: usize,
}

/// What a call does with environments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// Their states advance.
    Step,
    /// Their states stay, and what follows from them is computed.
    Forward,
    /// The same for somebody who only asks: nothing fails and nothing is counted.
    Query,
}

/// What a stepper has to report.
#[derive(Default)]
pub struct StepTotals {
    /// Environments that cannot go on, and why.
    pub faults: Vec<(u32, Fault)>,
    /// Environments that started over from the initial state.
    pub resets: Vec<u32>,
    pub divergence: Divergence,
    pub quality: Quality,
}

/// A thread's scratch in lanes of some width.
pub trait Stepper<S: Scalar + Shared>: Send {
    /// How many environments it steps at once.
    fn lanes(&self) -> usize;
    /// Does a job for a group of at most [`lanes`](Self::lanes) environments.
    fn run(&mut self, group: &[u32], job: &Job<S>);
    /// Answers a question about such a group.
    fn ask(&mut self, group: &[u32], asking: &Asking<S>);
    /// What happened since it was last cleared.
    fn totals(&mut self) -> &mut StepTotals;
    /// Lets its clocks run, or not.
    fn run_clocks(&mut self, running: bool);
    /// Where the time went while they ran.
    fn profile(&mut self) -> Profile;
}
