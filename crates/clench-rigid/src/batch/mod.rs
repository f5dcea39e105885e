//! Many environments of one model, stepped side by side in lanes and spread over threads.
//!
//! What users see is in rows, one an environment ([`Rows`], [`StateRows`]). A call (`run.rs`) puts running environments of like
//! contacts into groups; each thread has a stepper (`stepper.rs`), scratch in lanes, that claims a group, gathers its rows,
//! steps it as a [`Sim`](crate::Sim) would, and scatters the lanes that went well. What went wrong becomes a status. A device with
//! memory of its own ([`Backend`]) may step in place of the threads (`on_device.rs`).

mod answer;
mod ask;
mod ask_motion;
mod backend;
mod cells;
mod divergence;
mod dynamic;
mod env_rows;
mod group;
mod job;
mod mirror;
mod on_device;
mod options;
mod parameters;
mod precision;
mod quality;
mod record;
mod recorded_states;
mod reset;
mod rows;
mod run;
mod shared;
mod snapshot;
mod state_rows;
mod stepper;
mod summary;
mod targets;

pub use answer::Given;
pub use backend::{Backend, Outcome, Trouble};
pub use divergence::Divergence;
use env_rows::ParamRows;
use job::Stepper;
use mirror::Mirror;
pub use options::BatchOptions;
pub use precision::Precision;
pub(crate) use quality::StepResults;
pub use quality::{DeepContact, Quality, Violation};
pub use record::Recording;
pub use rows::Rows;
pub use snapshot::Snapshot;
pub use state_rows::StateRows;
pub use summary::Summary;
pub use targets::Controls;
use targets::{OutputRows, row_bytes};

use clench_dynamics::error::{Fault, SimError, no_such};
use clench_dynamics::model::Model;
use clench_dynamics::profile::Profile;
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_solver::Threads;
use recorded_states::RecordedStates;
use rows::{per_env, try_reserve};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Bytes of memory that an environment takes beside its rows: its status, how often it was reset, the serial number of the constraint
/// that was last added at run time, and its place in groups.
const BOOKKEEPING_BYTES: usize =
    size_of::<EnvStatus>() + size_of::<u64>() + size_of::<AtomicU64>() + 2 * size_of::<u32>();

/// Whether an environment takes part in steps.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvStatus {
    /// It does.
    Running,
    /// It stands still at its last good state until it is reset or revived.
    Failed(Fault),
}

/// Many environments of one model.
///
/// Environment i moves as a [`Sim`](crate::Sim) alone would in the same precision, to the bit: whatever instructions, threads,
/// neighbours and groups there are. One that cannot go on keeps its last good state and says why in
/// [`status`](Self::status); its neighbours do not notice.
pub struct Batch<S: Precision = f64> {
    /// The states of all environments.
    pub state: StateRows<S>,
    model: Arc<Model>,
    options: BatchOptions,
    settings: StepSettings,
    status: Vec<EnvStatus>,
    resets: Vec<u64>,
    /// For each environment the serial number of the constraint that was last added at run time.
    serials: Vec<u32>,
    params: Vec<ParamRows<S>>,
    outputs: Vec<OutputRows<S>>,
    recorded: Option<RecordedStates<S>>,
    initial: State<S>,
    scratch: State<S>,
    /// What environments are sorted by, so that those of like contacts come together.
    sort_keys: Vec<AtomicU64>,
    /// The environments that run, those of like contacts together.
    order: Vec<u32>,
    steppers: Vec<Box<dyn Stepper<S>>>,
    threads: Threads,
    /// The device that steps in place of the threads, if there is one.
    mirror: Option<Mirror<S>>,
    /// The process that the device is of.
    process: u32,
    divergence: Divergence,
    quality: Quality,
}

impl<S: Precision> fmt::Debug for Batch<S> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Batch")
            .field("model", &self.model.name)
            .field("count", &self.count())
            .field("lanes", &self.lanes())
            .field("threads", &self.threads())
            .finish_non_exhaustive()
    }
}

impl<S: Precision> Batch<S> {
    /// `count` environments in the model's initial state, with the model's options, on all processors.
    ///
    /// # Errors
    /// As [`with_options`](Self::with_options).
    pub fn new(model: Arc<Model>, count: usize) -> Result<Self, SimError> {
        Batch::with_options(model, count, BatchOptions::default())
    }

    /// `count` environments in the model's initial state.
    ///
    /// # Errors
    /// Options out of range; shapes that may meet and cannot be collided; instructions that the processor lacks; more
    /// environments than memory holds.
    pub fn with_options(
        model: Arc<Model>,
        count: usize,
        options: BatchOptions,
    ) -> Result<Self, SimError> {
        let settings = StepSettings::supported::<S>(&model, options.options)?;
        if u32::try_from(count).is_err() {
            return Err(SimError::OutOfRange {
                field: "number of environments",
                value: count as f64,
                range: "less than 2^32",
            });
        }
        try_reserve(count, StateRows::<S>::row_bytes(&model) + BOOKKEEPING_BYTES)?;
        let threads = options.threads(count)?;
        let instructions = options.instructions::<S>(count, threads.count())?;
        let stepper = || S::stepper(instructions, &model);
        let steppers = (0..threads.count())
            .map(|_| stepper())
            .collect::<Option<Vec<_>>>();
        let initial = State::new(&model);
        let mut state = StateRows::new(&model, count)?;
        for env in 0..count {
            state.write(env, &initial)?;
        }
        Ok(Batch {
            state,
            settings,
            status: per_env(count, || EnvStatus::Running)?,
            resets: per_env(count, || 0)?,
            serials: per_env(count, || 0)?,
            params: Vec::new(),
            outputs: Vec::new(),
            recorded: None,
            scratch: initial.clone(),
            initial,
            sort_keys: per_env(count, || AtomicU64::new(0))?,
            order: per_env(count, || 0)?,
            steppers: steppers.ok_or(SimError::Instructions(instructions))?,
            mirror: None,
            process: std::process::id(),
            divergence: Divergence::default(),
            quality: Quality::default(),
            options: BatchOptions {
                instructions: Some(instructions),
                threads: Some(threads.count()),
                ..options
            },
            threads,
            model,
        })
    }

    fn check_env(&self, env: usize) -> Result<(), SimError> {
        if env < self.count() {
            return Ok(());
        }
        Err(no_such("environment", env, self.count()))
    }

    fn check_envs(&self, envs: &[usize]) -> Result<(), SimError> {
        envs.iter().try_for_each(|&env| self.check_env(env))
    }

    /// Users can write all of [`state`](Self::state), and so put other tables in place of its own: those must have the same shapes.
    fn check_state(&self) -> Result<(), SimError> {
        self.state.check_shapes(&self.model, self.count())
    }

    /// A process that was forked has neither the threads nor the device of the batch, and a call would wait for them for ever.
    fn check_threads(&self) -> Result<(), SimError> {
        let device_is_lost = self.mirror.is_some() && self.process != std::process::id();
        if self.threads.are_lost() || device_is_lost {
            return Err(SimError::Forked);
        }
        Ok(())
    }

    /// Bytes that an environment takes: its state, the parameters of its own, the outputs that are kept and for which state they
    /// hold, whether it runs, and its place in groups; on a device, what it takes there.
    pub fn bytes_per_env(&self) -> usize {
        let device = self.mirror.as_ref();
        let device = device.map_or(0, |mirror| mirror.bytes_per_env(&self.model));
        let state = StateRows::<S>::row_bytes(&self.model);
        let params: usize = self.params.iter().map(ParamRows::row_bytes).sum();
        let recorded = self.recorded.as_ref().map_or(0, RecordedStates::row_bytes);
        state + params + row_bytes(&self.outputs) + recorded + BOOKKEEPING_BYTES + device
    }

    /// How many environments there are.
    pub fn count(&self) -> usize {
        self.status.len()
    }
    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// How it is stepped, decided.
    pub fn options(&self) -> BatchOptions {
        self.options
    }
    /// All options, decided.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// How many environments a thread steps side by side.
    pub fn lanes(&self) -> usize {
        self.steppers.first().map_or(1, |stepper| stepper.lanes())
    }
    /// How many threads step.
    pub fn threads(&self) -> usize {
        self.threads.count()
    }
    /// Whether each environment runs.
    pub fn statuses(&self) -> &[EnvStatus] {
        &self.status
    }
    /// Whether environment `env` runs.
    ///
    /// # Panics
    /// If there is no such environment, as slices do.
    pub fn status(&self, env: usize) -> EnvStatus {
        self.status[env].clone()
    }
    /// How often each environment started over from the initial state, with the option `autoreset`, since the last
    /// [`clear_figures`](Self::clear_figures).
    pub fn resets(&self) -> &[u64] {
        &self.resets
    }
    /// How unlike the environments of groups were since the last [`clear_figures`](Self::clear_figures).
    pub fn divergence(&self) -> Divergence {
        self.divergence
    }
    /// How well steps went since then.
    pub fn quality(&self) -> Quality {
        self.quality
    }
    /// Lets clocks run in every thread, or not.
    pub fn run_clocks(&mut self, running: bool) {
        for stepper in &mut self.steppers {
            stepper.run_clocks(running);
        }
    }
    /// Where the time of all threads went while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        let mut profile = Profile::default();
        for stepper in &mut self.steppers {
            profile.add(&stepper.profile());
        }
        profile
    }
    /// Begins the figures of [`divergence`](Self::divergence), [`quality`](Self::quality) and [`resets`](Self::resets) anew.
    pub fn clear_figures(&mut self) {
        self.resets.fill(0);
        self.divergence = Divergence::default();
        self.quality = Quality::default();
    }
}
