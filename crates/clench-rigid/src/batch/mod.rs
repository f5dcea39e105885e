//! Many environments of one model, stepped side by side in lanes and spread over threads.

mod cells;
mod divergence;
mod options;
mod parameters;
mod precision;
mod quality;
mod record;
mod rows;
mod snapshot;
mod state_rows;
mod stepper;

pub use divergence::Divergence;
pub use options::BatchOptions;
pub use precision::Precision;
pub use quality::Quality;
pub use record::{Controls, Recording};
pub use rows::Rows;
pub use snapshot::Snapshot;
pub use state_rows::StateRows;

use crate::check::check_length;
use crate::contact::check_supported;
use crate::error::{Fault, SimError};
use crate::model::Model;
use crate::profile::Profile;
use crate::settings::StepSettings;
use crate::sim::{Sim, no_such};
use crate::state::State;
use parameters::ParamRows;
use rayon::ThreadPool;
use rayon::prelude::*;
use record::{OutputRows, row_bytes, targets};
use rows::per_env;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use stepper::{Job, Stepper};

/// Whether an environment takes part in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EnvStatus {
    /// It does.
    Running,
    /// It stands still at its last good state until it is reset or revived.
    Failed(Fault),
}

/// What a call did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Environments that failed in this call.
    pub failed: usize,
    /// Environments that run on.
    pub running: usize,
}

/// After so many steps of a call environments are grouped anew.
const STEPS_A_GROUP: usize = 8;

/// Many environments of one model.
///
/// Environment i moves as a [`Sim`] alone would in the same precision, to the bit: whatever instructions, threads,
/// neighbours and groups there are. One that cannot go on keeps its last good state and says why in
/// [`status`](Self::status); its neighbours do not notice.
pub struct Batch<S: Precision = f64> {
    /// The states of all environments.
    pub state: StateRows<S>,
    model: Arc<Model>,
    options: BatchOptions,
    settings: StepSettings,
    status: Vec<EnvStatus>,
    params: Vec<ParamRows<S>>,
    outputs: Vec<OutputRows<S>>,
    initial: State<S>,
    scratch: State<S>,
    /// Where each environment stands among all by its last contacts.
    places: Vec<AtomicU64>,
    /// The environments that run, those of like contacts together.
    order: Vec<u32>,
    steppers: Vec<Box<dyn Stepper<S>>>,
    pool: Option<ThreadPool>,
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
        let settings = StepSettings::new::<S>(&model, options.options)?;
        if settings.flags.constraint && settings.flags.contact {
            check_supported(&model)?;
        }
        if u32::try_from(count).is_err() {
            return Err(SimError::OutOfRange {
                field: "count",
                value: count as f64,
                range: "less than 2^32",
            });
        }
        let threads = options.threads(count)?;
        let instructions = options.instructions::<S>(count, threads)?;
        let stepper = || S::stepper(instructions, &model);
        let steppers = (0..threads).map(|_| stepper()).collect::<Option<Vec<_>>>();
        let initial = State::new(&model);
        let mut state = StateRows::new(&model, count)?;
        for env in 0..count {
            state.write(env, &initial);
        }
        Ok(Batch {
            state,
            settings,
            status: per_env(count, || EnvStatus::Running)?,
            params: Vec::new(),
            outputs: Vec::new(),
            scratch: initial.clone(),
            initial,
            places: per_env(count, || AtomicU64::new(0))?,
            order: per_env(count, || 0)?,
            steppers: steppers.ok_or(SimError::Instructions(instructions))?,
            pool: (threads > 1).then(|| options.pool(threads)).transpose()?,
            divergence: Divergence::default(),
            quality: Quality::default(),
            options: BatchOptions {
                instructions: Some(instructions),
                threads: Some(threads),
                ..options
            },
            model,
        })
    }

    /// Advances every running environment by one time step.
    ///
    /// # Errors
    /// Tables of [`state`](Self::state) that are not those of this batch.
    pub fn step(&mut self) -> Result<Summary, SimError> {
        self.step_n(1)
    }

    /// Advances every running environment by `steps` time steps, with the same controls and applied forces.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_n(&mut self, steps: usize) -> Result<Summary, SimError> {
        self.run(true, steps, Controls::Held, &mut [])
    }

    /// Computes what follows from the states, and leaves them alone. An environment for which that fails stands still from
    /// now on.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn forward(&mut self) -> Result<Summary, SimError> {
        self.run(false, 1, Controls::Held, &mut [])
    }

    /// Does `steps` steps, or one forward pass, of every running environment.
    fn run(
        &mut self,
        advance: bool,
        steps: usize,
        controls: Controls<S>,
        trace: &mut [OutputRows<S>],
    ) -> Result<Summary, SimError> {
        self.state.check_shapes(&self.model, self.count())?;
        let mut summary = Summary {
            failed: 0,
            running: 0,
        };
        for first in (0..steps).step_by(STEPS_A_GROUP) {
            self.regroup();
            let (motion, inputs) = self.state.share();
            let job = Job {
                model: &self.model,
                settings: &self.settings,
                motion,
                inputs,
                params: &self.params,
                targets: targets(&mut self.outputs, trace),
                places: &self.places,
                advance,
                controls,
                first,
                end: steps.min(first.saturating_add(STEPS_A_GROUP)),
                steps,
            };
            spread(&mut self.steppers, self.pool.as_ref(), &self.order, &job);
            summary.failed += self.settle();
        }
        let running = |status: &&EnvStatus| **status == EnvStatus::Running;
        summary.running = self.status.iter().filter(running).count();
        Ok(summary)
    }

    /// Lists the environments that run, those of like contacts side by side.
    fn regroup(&mut self) {
        let running = |env: &u32| self.status[*env as usize] == EnvStatus::Running;
        self.order.clear();
        let envs = 0..self.status.len() as u32;
        self.order.extend(envs.filter(running));
        if self.options.grouping {
            let place = |env: &u32| self.places[*env as usize].load(Relaxed);
            self.order.sort_unstable_by_key(place);
        }
    }

    /// Takes over what the steppers have to report; how many environments failed.
    fn settle(&mut self) -> usize {
        let mut failed = 0;
        for stepper in &mut self.steppers {
            let tally = stepper.tally();
            for (env, fault) in tally.faults.drain(..) {
                self.status[env as usize] = EnvStatus::Failed(fault);
                failed += 1;
            }
            self.divergence += std::mem::take(&mut tally.divergence);
            self.quality += std::mem::take(&mut tally.quality);
        }
        failed
    }

    /// Environment `env` back to the model's initial state, running.
    ///
    /// # Errors
    /// An environment that the batch does not have.
    pub fn reset(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.state.write(env, &self.initial);
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// Environment `env` to a keyframe of the model, running; what a keyframe does not hold is as in the initial state.
    ///
    /// # Errors
    /// An environment that the batch or a keyframe that the model does not have.
    pub fn reset_to_keyframe(&mut self, env: usize, key: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        let Some(keyframe) = self.model.keyframes.get(key) else {
            return Err(no_such("keyframe", key, self.model.keyframes.len()));
        };
        self.scratch.copy_from(&self.initial);
        self.scratch.set_keyframe(keyframe);
        self.state.write(env, &self.scratch);
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// As [`reset`](Self::reset), for every environment where `mask` is true.
    ///
    /// # Errors
    /// A mask of another length than there are environments.
    pub fn reset_mask(&mut self, mask: &[bool]) -> Result<(), SimError> {
        check_length("mask", mask.len(), self.count())?;
        let mut masked = (0..self.count()).filter(|&env| mask[env]);
        masked.try_for_each(|env| self.reset(env))
    }

    /// Lets environment `env` run on from the state in its rows.
    ///
    /// # Errors
    /// An environment that the batch does not have.
    pub fn revive(&mut self, env: usize) -> Result<(), SimError> {
        self.check_env(env)?;
        self.status[env] = EnvStatus::Running;
        Ok(())
    }

    /// A simulation of one environment, in the state of `env`.
    ///
    /// # Errors
    /// An environment that the batch does not have.
    pub fn sim(&self, env: usize) -> Result<Sim<S>, SimError> {
        self.check_env(env)?;
        let mut sim = Sim::with_options(Arc::clone(&self.model), self.options.options)?;
        self.state.read(env, &mut sim.state);
        for own in &self.params {
            own.read(env, 0, sim.params_mut());
        }
        Ok(sim)
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

    /// Bytes that an environment takes: its state, the parameters of its own, the outputs that are kept, whether it runs,
    /// and its place in groups.
    pub fn bytes_per_env(&self) -> usize {
        let groups = size_of::<AtomicU64>() + size_of::<u32>();
        let params: usize = self.params.iter().map(ParamRows::row_bytes).sum();
        let rows = self.state.row_bytes() + params + row_bytes(&self.outputs);
        rows + size_of::<EnvStatus>() + groups
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
        self.steppers.len()
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
        self.status[env]
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
    /// Begins the figures of [`divergence`](Self::divergence) and [`quality`](Self::quality) anew.
    pub fn clear_figures(&mut self) {
        self.divergence = Divergence::default();
        self.quality = Quality::default();
    }
}

/// Does a job for all environments in `order`. Groups are claimed one by one, so that threads end together though groups take
/// unlike times.
fn spread<S: Precision>(
    steppers: &mut [Box<dyn Stepper<S>>],
    pool: Option<&ThreadPool>,
    order: &[u32],
    job: &Job<S>,
) {
    let next = AtomicUsize::new(0);
    let work = |stepper: &mut Box<dyn Stepper<S>>| {
        let lanes = stepper.lanes();
        while let Some(group) = order.chunks(lanes).nth(next.fetch_add(1, Relaxed)) {
            stepper.run(group, job);
        }
    };
    match pool {
        None => steppers.iter_mut().for_each(work),
        Some(pool) => pool.install(|| steppers.par_iter_mut().with_max_len(1).for_each(work)),
    }
}
