//! Steps of a batch: environments are grouped, threads claim groups, and environments that failed are reported.

use super::env_rows::EnvRows;
use super::job::{Call, Job, Pass, Stepper};
use super::recorded_states::RecordedStates;
use super::summary::Summary;
use super::targets::{OutputRows, targets};
use super::{Batch, EnvStatus, Precision};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

/// The number of steps of a call after which environments are regrouped.
const STEPS_A_GROUP: usize = 8;

impl<S: Precision> Batch<S> {
    /// Advances every running environment by one time step.
    ///
    /// With the option `autoreset`, a step that fails (except beyond `max_contacts` or the budget) is repeated from
    /// the initial state, including applied forces, mocap poses and switches, and is counted in
    /// [`resets`](Self::resets). Controls are reset too, except those of a rollout.
    ///
    /// # Errors
    /// Returns an error if tables of [`state`](Self::state) have wrong shapes, or after a fork of a batch with threads.
    pub fn step(&mut self) -> Result<Summary, SimError> {
        self.step_n(1)
    }

    /// Advances every running environment by `steps` time steps, with the same controls and applied forces.
    ///
    /// # Errors
    /// See [`step`](Self::step).
    pub fn step_n(&mut self, steps: usize) -> Result<Summary, SimError> {
        self.run(&Call::steps(steps), &mut [])
    }

    /// Computes the results of the states without changing them. An environment for which that fails stops running.
    ///
    /// # Errors
    /// See [`step`](Self::step).
    pub fn forward(&mut self) -> Result<Summary, SimError> {
        self.run(&Call::forward(Pass::Forward, None), &mut [])
    }

    /// Runs [`forward`](Self::forward) only for the running environments whose `mask` is true. The outputs of the
    /// others do not change.
    ///
    /// # Errors
    /// Returns an error as [`step`](Self::step) does, or if the mask has a wrong length.
    pub fn forward_mask(&mut self, mask: &[bool]) -> Result<Summary, SimError> {
        check_length("mask", mask.len(), self.count())?;
        self.run(&Call::forward(Pass::Forward, Some(mask)), &mut [])
    }

    /// Recomputes the recorded outputs of running environments whose positions, velocities, mocap poses or parameters
    /// were written, or that were reset, since the last step or forward pass. Others do not change: after a step,
    /// outputs are those of the start of the last time step, as in MuJoCo. Nor do those of an invalid state, which the
    /// next step or forward pass reports.
    ///
    /// # Errors
    /// See [`step`](Self::step).
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

    /// Runs a forward pass that changes only the recorded outputs: no status, no statistic, no state.
    pub(super) fn query(&mut self, mask: Option<&[bool]>) -> Result<(), SimError> {
        self.run(&Call::forward(Pass::Query, mask), &mut [])?;
        Ok(())
    }

    /// Runs a call, and stores the outputs of each of its steps in `trace`.
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
        // All groups of a call run inside the pool, so that its threads need not be woken for each.
        let threads = self.threads.clone();
        Ok(threads.run(|| self.run_here(call, trace)))
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
                    models: &self.models,
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

    /// Lists the running environments in the mask, with similar contacts next to each other.
    fn regroup(&mut self, mask: Option<&[bool]>) {
        let status = &self.status;
        let running = |env: &u32| status[*env as usize] == EnvStatus::Running;
        let wanted = |env: &u32| mask.is_none_or(|mask| mask[*env as usize]);
        self.order.clear();
        let envs = 0..self.status.len() as u32;
        (self.order).extend(envs.filter(|env| running(env) && wanted(env)));
        if self.options.grouping {
            let groups = self.models.groups();
            sort(&mut self.order, groups, &self.sort_keys);
        }
    }

    /// Collects the reports of the steppers.
    fn collect_reports(&mut self, summary: &mut Summary) {
        for stepper in &mut self.steppers {
            let totals = stepper.totals();
            for env in totals.resets.drain(..) {
                let initial = self.models.initial(env as usize);
                self.state.write_inputs(env as usize, initial);
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

/// Sorts environments by their group, if they have one, and then by their sort key.
fn sort(order: &mut [u32], groups: Option<&[u32]>, keys: &[AtomicU64]) {
    order.sort_unstable_by_key(|&env| {
        let group = groups.map_or(0, |groups| groups[env as usize]);
        (group, keys[env as usize].load(Relaxed))
    });
}

/// Runs a job for all environments in `order`. Groups are claimed one by one to balance the load of the threads.
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
