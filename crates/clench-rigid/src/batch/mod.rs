//! Many environments of one or several models, stepped in SIMD lanes on several threads.
//!
//! User-visible data is in tables with one row per environment ([`Rows`], [`StateRows`]). A call (`run.rs`) groups
//! running environments with similar contacts. Each thread has a stepper (`stepper.rs`) with scratch memory in lanes,
//! which claims a group, gathers its rows, steps it as a [`Sim`](crate::Sim) would, and scatters the lanes that
//! succeeded. A failure is reported as a status. A device with its own memory ([`Backend`]) may replace the threads
//! (`on_device.rs`).

mod answer;
mod backend;
mod cells;
mod divergence;
mod dynamic;
mod env_rows;
mod group;
pub(crate) mod job;
mod mirror;
mod models;
mod motion_queries;
mod on_device;
mod options;
mod parameters;
mod quality;
mod queries;
mod record;
mod recorded_states;
mod reset;
mod rows;
mod run;
mod several_models;
pub(crate) mod shared;
mod snapshot;
mod state_rows;
pub(crate) mod stepper;
mod summary;
mod targets;

pub use crate::precision::Precision;
pub use crate::query::QueryInput;
pub use backend::{Backend, Outcome, StepFailure};
pub use divergence::Divergence;
use env_rows::ParamRows;
use job::Stepper;
use mirror::Mirror;
use models::Models;
pub use motion_queries::Anchors;
pub use options::BatchOptions;
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

/// The memory of an environment in addition to its rows, in bytes: its status, its number of resets, the serial number
/// of the last constraint added at run time, its sort key and its index in groups.
const BOOKKEEPING_BYTES: usize =
    size_of::<EnvStatus>() + size_of::<u64>() + size_of::<AtomicU64>() + 2 * size_of::<u32>();

/// The status of an environment.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvStatus {
    /// The environment runs.
    Running,
    /// The environment keeps its last good state until it is reset or revived.
    Failed(Fault),
}

/// Many environments of one model, or of [several](Self::of_models).
///
/// Environment i moves exactly as a single [`Sim`](crate::Sim) in the same precision, bit for bit, independent of
/// instructions, threads, neighbours and groups. An environment that fails keeps its last good state and reports the
/// fault in [`status`](Self::status); its neighbours are not affected.
pub struct Batch<S: Precision = f64> {
    /// The states of all environments.
    pub state: StateRows<S>,
    /// The model, or the common layout of several.
    model: Arc<Model>,
    models: Models<S>,
    options: BatchOptions,
    settings: StepSettings,
    status: Vec<EnvStatus>,
    resets: Vec<u64>,
    /// The serial number of the last constraint that was added at run time, for each environment.
    serials: Vec<u32>,
    params: Vec<ParamRows<S>>,
    outputs: Vec<OutputRows<S>>,
    recorded: Option<RecordedStates<S>>,
    scratch: State<S>,
    /// The sort keys, which place environments with similar contacts next to each other.
    sort_keys: Vec<AtomicU64>,
    /// The running environments in the order of their sort keys.
    order: Vec<u32>,
    steppers: Vec<Box<dyn Stepper<S>>>,
    threads: Threads,
    /// The device that replaces the threads, if there is one.
    mirror: Option<Mirror<S>>,
    /// The process that owns the device.
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
    /// Creates `count` environments in the model's initial state, with the model's options, on all processors.
    ///
    /// # Errors
    /// See [`with_options`](Self::with_options).
    pub fn new(model: Arc<Model>, count: usize) -> Result<Self, SimError> {
        Batch::with_options(model, count, BatchOptions::default())
    }

    /// Creates `count` environments in the model's initial state.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if a possible collision is not supported, if the processor lacks
    /// the instructions, or if memory is insufficient.
    pub fn with_options(
        model: Arc<Model>,
        count: usize,
        options: BatchOptions,
    ) -> Result<Self, SimError> {
        let settings = StepSettings::supported::<S>(&model, options.options)?;
        let model = settings.adapt(model);
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
        let models = Models::one(&model);
        let initial = models.initial(0);
        let mut state = StateRows::new(&model, count)?;
        for env in 0..count {
            state.write(env, initial)?;
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
            models,
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

    /// Checks the shapes of the tables in [`state`](Self::state), which users may replace.
    fn check_state(&self) -> Result<(), SimError> {
        self.state.check_shapes(&self.model, self.count())
    }

    /// Returns an error after a fork: the new process has neither the threads nor the device, and a call would wait
    /// forever.
    fn check_threads(&self) -> Result<(), SimError> {
        let device_is_lost = self.mirror.is_some() && self.process != std::process::id();
        if self.threads.are_lost() || device_is_lost {
            return Err(SimError::Forked);
        }
        Ok(())
    }

    /// Returns the memory of an environment in bytes: its state, parameters, recorded outputs and their states,
    /// bookkeeping, and memory on a device.
    pub fn bytes_per_env(&self) -> usize {
        let device = self.mirror.as_ref();
        let device = device.map_or(0, |mirror| mirror.bytes_per_env(&self.model));
        let state = StateRows::<S>::row_bytes(&self.model);
        let params: usize = self.params.iter().map(ParamRows::row_bytes).sum();
        let recorded = self.recorded.as_ref().map_or(0, RecordedStates::row_bytes);
        state + params + row_bytes(&self.outputs) + recorded + BOOKKEEPING_BYTES + device
    }

    /// Returns the number of environments.
    pub fn count(&self) -> usize {
        self.status.len()
    }
    /// Returns the model, or the common layout of several.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// Returns the resolved options.
    pub fn options(&self) -> BatchOptions {
        self.options
    }
    /// Returns all resolved options.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// Returns the number of environments that a thread steps at once.
    pub fn lanes(&self) -> usize {
        self.steppers.first().map_or(1, |stepper| stepper.lanes())
    }
    /// Returns the number of threads.
    pub fn threads(&self) -> usize {
        self.threads.count()
    }
    /// Returns the status of each environment.
    pub fn statuses(&self) -> &[EnvStatus] {
        &self.status
    }
    /// Returns the status of environment `env`.
    ///
    /// # Panics
    /// Panics if the environment does not exist.
    pub fn status(&self, env: usize) -> EnvStatus {
        self.status[env].clone()
    }
    /// Returns the number of `autoreset` resets of each environment since the last
    /// [`clear_figures`](Self::clear_figures).
    pub fn resets(&self) -> &[u64] {
        &self.resets
    }
    /// Returns the divergence within groups since the last [`clear_figures`](Self::clear_figures).
    pub fn divergence(&self) -> Divergence {
        self.divergence
    }
    /// Returns the quality of steps since [`clear_figures`](Self::clear_figures).
    pub fn quality(&self) -> Quality {
        self.quality
    }
    /// Starts or stops the clocks of every thread.
    pub fn run_clocks(&mut self, running: bool) {
        for stepper in &mut self.steppers {
            stepper.run_clocks(running);
        }
    }
    /// Returns the time of all threads in each stage while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        let mut profile = Profile::default();
        for stepper in &mut self.steppers {
            profile.add(&stepper.profile());
        }
        profile
    }
    /// Resets [`divergence`](Self::divergence), [`quality`](Self::quality) and [`resets`](Self::resets).
    pub fn clear_figures(&mut self) {
        self.resets.fill(0);
        self.divergence = Divergence::default();
        self.quality = Quality::default();
    }
}
