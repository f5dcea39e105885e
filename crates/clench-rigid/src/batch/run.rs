//! Stepping a batch: environments are grouped, threads claim groups, and what went wrong becomes a status.

use super::env_rows::EnvRows;
use super::job::{Call, Job, Pass, Stepper};
use super::recorded_states::RecordedStates;
use super::summary::Summary;
use super::targets::{OutputRows, targets};
use super::{Batch, EnvStatus, Precision};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Environments are grouped anew after this many steps of a call.
const STEPS_A_GROUP: usize = 8;

impl<S: Precision> Batch<S> {
    /// Advances every running environment by one time step.
    ///
    /// With the option `autoreset` a step that cannot be done (but for too many contacts) starts over from the initial state,
    /// applied forces, mocap poses and switches included, and counts in [`resets`](Self::resets). Controls start over too, but
    /// for those of a rollout.
    ///
    /// # Errors
    /// Tables of [`state`](Self::state) that are not those of this batch; a batch of several threads after a fork.
    pub fn step(&mut self) -> Result<Summary, SimError> {
        self.step_n(1)
    }

    /// Advances every running environment by `steps` time steps, with the same controls and applied forces.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_n(&mut self, steps: usize) -> Result<Summary, SimError> {
        self.run(&Call::steps(steps), &mut [])
    }

    /// Computes what follows from the states, and leaves them alone. An environment for which that fails stands still from
    /// now on.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn forward(&mut self) -> Result<Summary, SimError> {
        self.run(&Call::forward(Pass::Forward, None), &mut [])
    }

    /// As [`forward`](Self::forward), only for the running environments where `mask` is true. Of the others nothing changes:
    /// their outputs stay as they are.
    ///
    /// # Errors
    /// As [`step`](Self::step), and a mask of another length than there are environments.
    pub fn forward_mask(&mut self, mask: &[bool]) -> Result<Summary, SimError> {
        check_length("mask", mask.len(), self.count())?;
        self.run(&Call::forward(Pass::Forward, Some(mask)), &mut [])
    }

    /// Computes the outputs that are kept anew for running environments whose positions, velocities, mocap poses or parameters were
    /// written, or that were reset, since the last step or forward pass. Nothing is done for the others: after a step outputs are, as
    /// in MuJoCo, those of the start of the last time step. Where a state cannot be stepped from, outputs stay as they are; the
    /// next step or forward pass says so.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn refresh(&mut self) -> Result<(), SimError> {
        self.check_state()?;
        let Some(recorded) = &self.recorded else {
            return Ok(());
        };
        let runs = |env: usize| self.status[env] == EnvStatus::Running;
        let stale = |env: usize| runs(env) && !recorded.holds(env, &self.state);
        let stale = Vec::from_iter((0..self.count()).map(stale));
        if stale.contains(&true) {
            self.query(Some(&stale))?;
        }
        Ok(())
    }

    /// A forward pass that changes nothing but the outputs that are kept: no status, no figure, no state.
    pub(super) fn query(&mut self, mask: Option<&[bool]>) -> Result<(), SimError> {
        self.run(&Call::forward(Pass::Query, mask), &mut [])?;
        Ok(())
    }

    /// Does a call, and puts the outputs of each of its steps into `trace`.
    pub(super) fn run(
        &mut self,
        call: &Call<S>,
        trace: &mut [OutputRows<S>],
    ) -> Result<Summary, SimError> {
        self.check_state()?;
        self.check_threads()?;
        if let Some(mut mirror) = self.mirror.take() {
            let done = self.run_on_device(&mut mirror, call, trace);
            self.mirror = Some(mirror);
            return done;
        }
        // All groupings of a call run inside the pool, so that its threads need not be woken for each.
        let threads = self.threads.clone();
        Ok(threads.enter(|| self.run_here(call, trace)))
    }

    fn run_here(&mut self, call: &Call<S>, trace: &mut [OutputRows<S>]) -> Summary {
        let mut summary = Summary {
            failed: 0,
            running: 0,
            resets: 0,
        };
        for first in call.range.clone().step_by(STEPS_A_GROUP) {
            self.regroup(call.mask);
            if self.order.is_empty() {
                break;
            }
            let (motion, inputs) = self.state.share();
            let job = Job {
                model: &self.model,
                settings: &self.settings,
                rows: EnvRows {
                    motion,
                    inputs,
                    params: &self.params,
                },
                targets: targets(&mut self.outputs, trace),
                sort_keys: &self.sort_keys,
                pass: call.pass,
                recorded: self.recorded.as_mut().map(RecordedStates::share),
                controls: call.controls,
                first,
                end: call.range.end.min(first.saturating_add(STEPS_A_GROUP)),
                steps: call.steps,
            };
            for_each_group(&mut self.steppers, &self.order, |stepper, group| {
                stepper.run(group, &job)
            });
            self.collect_reports(&mut summary);
        }
        let running = |status: &&EnvStatus| **status == EnvStatus::Running;
        summary.running = self.status.iter().filter(running).count();
        summary
    }

    /// Lists the environments that run and are not masked out, those of like contacts side by side.
    fn regroup(&mut self, mask: Option<&[bool]>) {
        let status = &self.status;
        let running = |env: &u32| status[*env as usize] == EnvStatus::Running;
        let wanted = |env: &u32| mask.is_none_or(|mask| mask[*env as usize]);
        self.order.clear();
        let envs = 0..self.status.len() as u32;
        (self.order).extend(envs.filter(|env| running(env) && wanted(env)));
        if self.options.grouping {
            let place = |env: &u32| self.sort_keys[*env as usize].load(Relaxed);
            self.order.sort_unstable_by_key(place);
        }
    }

    /// Collects what the steppers report.
    fn collect_reports(&mut self, summary: &mut Summary) {
        for stepper in &mut self.steppers {
            let totals = stepper.totals();
            for env in totals.resets.drain(..) {
                self.state.write_inputs(env as usize, &self.initial);
                self.resets[env as usize] += 1;
                summary.resets += 1;
            }
            for (env, fault) in totals.faults.drain(..) {
                self.status[env as usize] = EnvStatus::Failed(fault);
                summary.failed += 1;
            }
            self.divergence += std::mem::take(&mut totals.divergence);
            self.quality += std::mem::take(&mut totals.quality);
        }
    }
}

/// Does a job for all environments in `order`. Groups are claimed one by one, so that threads end together though groups take
/// unlike times.
pub(super) fn for_each_group<S: Precision>(
    steppers: &mut [Box<dyn Stepper<S>>],
    order: &[u32],
    job: impl Fn(&mut dyn Stepper<S>, &[u32]) + Sync,
) {
    let next = AtomicUsize::new(0);
    let work = |stepper: &mut Box<dyn Stepper<S>>| {
        let lanes = stepper.lanes();
        while let Some(group) = order.chunks(lanes).nth(next.fetch_add(1, Relaxed)) {
            job(&mut **stepper, group);
        }
    };
    match steppers {
        [alone] => work(alone),
        _ => steppers.par_iter_mut().with_max_len(1).for_each(work),
    }
}
