//! The step of a group of environments: a thread gathers them, steps them in lanes, and scatters those that succeeded.
//! The rows of an environment that failed stay at its last good state, and its status reports the fault.

use super::answer::{QueryCall, QueryMemory};
use super::env_rows::EnvRows;
use super::group::{Group, MAX_LANES};
use super::job::{Job, Pass, StepTotals, Stepper};
use super::quality::StepResults;
use super::shared::Shared;
use super::state_rows::clear_occasional;
use crate::output::{Output, Source};
use crate::sensor;
use clench_dynamics::error::Fault;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::options::MaxContacts;
use clench_dynamics::profile::{Profile, Stage};
use clench_dynamics::state::State;
use clench_dynamics::state::kind::Number;
use clench_dynamics::workspace::Workspace;
use clench_dynamics::{Step, StepContext, check};
use clench_math::{Clock, LaneTask, Mask, Real, Scalar, write_lane};
use std::sync::atomic::Ordering::Relaxed;

/// Creates a stepper in lanes chosen at run time.
pub(crate) struct MakeStepper<'a> {
    pub model: &'a Model,
}

impl<S: Scalar + Shared> LaneTask<S> for MakeStepper<'_> {
    type Output = Box<dyn Stepper<S>>;
    fn run<T: Real<Scalar = S>>(self) -> Self::Output {
        Box::new(LaneStepper::<T>::new(self.model))
    }
}

pub(super) struct LaneStepper<T: Real> {
    compiled: Step<T>,
    state: State<T>,
    params: Params<T>,
    ws: Workspace<T>,
    /// True if the state contains occasional inputs.
    has_occasional: bool,
    /// The output that is being copied.
    output: Vec<T>,
    /// Environments to be reset to the initial state, with the step to repeat.
    restarts: Vec<(u32, usize)>,
    /// Scratch memory of queries.
    memory: QueryMemory<T>,
    totals: StepTotals,
}

/// The start state of a group.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    /// The state in the rows.
    Rows,
    /// The initial state of its only environment.
    Initial,
}

impl<T: Real> LaneStepper<T>
where
    T::Scalar: Shared,
{
    fn new(model: &Model) -> Self {
        let compiled = Step::compiled();
        LaneStepper {
            compiled,
            state: State::new(model),
            params: model.params.broadcast(),
            ws: (compiled.workspace)(model),
            has_occasional: false,
            output: Vec::new(),
            restarts: Vec::new(),
            memory: QueryMemory::new(),
            totals: StepTotals::default(),
        }
    }

    /// Copies the rows of a group into the lanes. All that a step uses is read here, once, and then checked: concurrent
    /// writes through pointers can only mix values.
    fn gather(&mut self, group: &Group<T>, rows: &EnvRows<T::Scalar>) {
        self.ws.collision.environments.clear();
        for (lane, env) in group.fill() {
            self.ws.collision.environments.push(env as u32);
            rows.motion.read(env, lane, &mut self.state);
            rows.inputs.read(env, lane, &mut self.state);
            if rows.models.are_several() {
                rows.models.read(env, lane, &mut self.params);
            }
            for own in rows.params {
                own.read(env, lane, &mut self.params);
            }
        }
        if rows.models.are_several() || !rows.params.is_empty() {
            self.ws.invalidate_poses();
        }
        let has_occasional = (group.iter()).any(|(_, env)| rows.inputs.has_occasional(env));
        if has_occasional {
            for (lane, env) in group.fill() {
                rows.inputs.read_occasional(env, lane, &mut self.state);
            }
        } else if self.has_occasional {
            clear_occasional(&mut self.state);
        }
        self.has_occasional = has_occasional;
    }

    /// Runs the steps of a job, starting with `step`.
    fn advance(
        &mut self,
        mut group: Group<T>,
        mut start: Start,
        mut step: usize,
        job: &Job<T::Scalar>,
    ) {
        while step < job.end && group.len > 0 {
            self.ws.clock.start();
            self.gather(&group, &job.rows);
            if start == Start::Initial {
                // Such a group has one environment.
                let (_, env) = group.fill().next().unwrap_or_default();
                self.state.splat_from(job.rows.models.initial(env));
            }
            while step < job.end && group.len > 0 {
                self.control(&group, step, job);
                if !self.check_inputs(&mut group, (start, step), job) {
                    break;
                }
                self.ws.clock.lap(Stage::Rows as usize);
                let whole = self.step(&mut group, (start, step), job);
                self.ws.clock.lap(Stage::Rows as usize);
                step += 1;
                start = Start::Rows;
                if !whole {
                    break;
                }
            }
        }
    }

    /// Copies the controls of a rollout's step into the lanes.
    fn control(&mut self, group: &Group<T>, step: usize, job: &Job<T::Scalar>) {
        let nu = self.state.ctrl.len();
        for (lane, env) in group.fill() {
            if let Some(row) = job.controls.row(env, step, job.steps, nu) {
                write_lane(row, lane, &mut self.state.ctrl);
            }
        }
    }

    /// Removes environments with an invalid state from the group. Returns true if all remain.
    fn check_inputs(
        &mut self,
        group: &mut Group<T>,
        (start, step): (Start, usize),
        job: &Job<T::Scalar>,
    ) -> bool {
        let good = check::good_inputs(&self.state, self.has_occasional);
        if !good.all() {
            for (lane, env) in group.iter().filter(|&(lane, _)| !good.lane(lane)) {
                let fault = check::input_fault(job.model, &self.state, lane);
                self.fail((env, fault), (start, step), job);
            }
            group.retain(good);
        }
        good.all()
    }

    /// Records that an environment failed, or that its step must be repeated from the initial state: if `autoreset` is
    /// on and it was not just reset.
    fn fail(
        &mut self,
        (env, fault): (usize, Fault),
        (start, step): (Start, usize),
        job: &Job<T::Scalar>,
    ) {
        if job.pass == Pass::Query {
            return;
        }
        let out_of_capacity = matches!(
            fault,
            Fault::ContactOverflow { .. } | Fault::OverBudget { .. }
        );
        let may_restart = job.settings.autoreset && job.pass == Pass::Step;
        if may_restart && start == Start::Rows && !out_of_capacity {
            self.restarts.push((env as u32, step));
        } else {
            self.totals.faults.push((env as u32, fault));
        }
    }

    /// Runs one step of all lanes. Environments that fail leave the group, and their rows do not change. Returns true
    /// if all remain.
    fn step(
        &mut self,
        group: &mut Group<T>,
        (start, step): (Start, usize),
        job: &Job<T::Scalar>,
    ) -> bool {
        let (model, settings) = (job.model, job.settings);
        let time = self.state.time;
        let (state, ws) = (&mut self.state, &mut self.ws);
        let context = StepContext {
            model,
            params: &self.params,
            settings,
            sensors: sensor::evaluate,
        };
        if job.pass == Pass::Step {
            (self.compiled.step)(context, state, ws);
        } else {
            (self.compiled.forward)(context, state, ws);
        }
        let overflow = ws.collision.overflow;
        let within = check::good_results(state, ws);
        let good = within & !overflow;
        for (lane, env) in group.iter().filter(|&(lane, _)| !good.lane(lane)) {
            let time = time.lane(lane);
            let fault = match settings.max_contacts {
                MaxContacts::Limit(limit) if within.lane(lane) => {
                    Fault::ContactOverflow { time, limit }
                }
                MaxContacts::Auto | MaxContacts::Limit(_) => {
                    check::result_fault(model, time, &self.state, &self.ws, lane)
                }
            };
            self.fail((env, fault), (start, step), job);
        }
        if start == Start::Initial && good.all() {
            let envs = group.iter().map(|(_, env)| env as u32);
            self.totals.resets.extend(envs);
        }
        self.scatter(group, good, job);
        self.record(group, good, step, job);
        group.retain(good);
        good.all()
    }

    /// Copies the states of the good lanes into their rows.
    fn scatter(&mut self, group: &Group<T>, good: T::Mask, job: &Job<T::Scalar>) {
        let mut signatures = [0; MAX_LANES];
        for contact in &self.ws.contacts {
            let [a, b] = contact.geoms.map(|g| g as u64);
            for (lane, signature) in signatures.iter_mut().enumerate().take(T::LANES) {
                if contact.active.lane(lane) {
                    *signature |= contact_bit(a, b);
                }
            }
        }
        let asleep = self.ws.sleep.all_asleep();
        for (lane, env) in group.iter().filter(|&(lane, _)| good.lane(lane)) {
            if job.pass == Pass::Step {
                job.rows.motion.write(env, lane, &self.state);
            }
            let rank = match asleep.lane(lane) {
                true => ASLEEP_RANK,
                false => gray_rank(signatures[lane]),
            };
            job.sort_keys[env].store(rank, Relaxed);
        }
        if job.pass == Pass::Query {
            return;
        }
        self.totals.divergence.count(&self.ws, group.len);
        let results = StepResults {
            model: job.model,
            params: &self.params,
            settings: job.settings,
            ws: &self.ws,
        };
        self.totals.quality.count(results, group.len, good);
    }

    /// Copies the outputs of a step to their targets.
    fn record(&mut self, group: &Group<T>, good: T::Mask, step: usize, job: &Job<T::Scalar>) {
        let last = step + 1 == job.steps;
        if let Some(recorded) = job.recorded.as_ref().filter(|_| last) {
            for (lane, env) in group.iter().filter(|&(lane, _)| good.lane(lane)) {
                recorded.record(env, lane, &self.state);
            }
        }
        for (&output, target) in Output::ALL.iter().zip(&job.targets) {
            let kept = target.last.as_ref().filter(|_| last);
            if kept.is_none() && target.trace.is_none() {
                continue;
            }
            let mut source = Source {
                model: job.model,
                params: &self.params,
                state: &self.state,
                ws: &mut self.ws,
            };
            self.output.clear();
            output.read(&mut source, &mut self.output);
            let start = step * self.output.len();
            for (lane, env) in group.iter().filter(|&(lane, _)| good.lane(lane)) {
                if let Some(cells) = kept {
                    cells.write::<Number, T>(env, lane, &self.output);
                }
                if let Some(cells) = &target.trace {
                    cells.write_part(env, start, lane, &self.output);
                }
            }
        }
    }
}

/// The rank of environments in which everything sleeps. A group of them costs almost nothing.
const ASLEEP_RANK: u64 = u64::MAX;

/// Returns one of 64 bits for a pair of geoms.
fn contact_bit(a: u64, b: u64) -> u64 {
    // Fibonacci hashing: the upper bits of a multiple of the golden ratio spread neighbours well.
    let hash = (a << 32 | b).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    1 << (hash >> 58)
}

/// Returns the rank of a bit set in Gray code order, where neighbours differ by one bit. In numerical order, very
/// different sets can be neighbours. Saves 3% of contact slots (measured).
fn gray_rank(mut bits: u64) -> u64 {
    for shift in [1, 2, 4, 8, 16, 32] {
        bits ^= bits >> shift;
    }
    bits
}

impl<T: Real> Stepper<T::Scalar> for LaneStepper<T>
where
    T::Scalar: Shared,
{
    fn lanes(&self) -> usize {
        T::LANES
    }

    fn run(&mut self, envs: &[u32], job: &Job<T::Scalar>) {
        let sensors = &job.targets[Output::sensordata as usize];
        self.ws.sensors.wanted = sensors.last.is_some() || sensors.trace.is_some();
        let targets = job.targets.iter();
        self.ws.read = { targets }.any(|target| target.last.is_some() || target.trace.is_some());
        self.advance(Group::new(envs), Start::Rows, job.first, job);
        // Each is repeated separately, with identical results.
        while let Some((env, step)) = self.restarts.pop() {
            self.advance(Group::new(&[env]), Start::Initial, step, job);
        }
    }

    fn query(&mut self, envs: &[u32], call: &QueryCall<T::Scalar>) {
        let mut group = Group::new(envs);
        let good = loop {
            if group.len == 0 {
                return;
            }
            self.gather(&group, &call.rows);
            let good = check::good_inputs(&self.state, self.has_occasional);
            if good.all() {
                break good;
            }
            group.retain(good);
        };
        self.output.clear();
        let lanes = (&self.params, &self.state, &mut self.ws);
        let good = good & call.answer(&group, lanes, &mut self.memory, &mut self.output);
        for (lane, env) in group.iter().filter(|&(lane, _)| good.lane(lane)) {
            (call.answers).write::<Number, T>(env, lane, &self.output);
        }
    }

    fn totals(&mut self) -> &mut StepTotals {
        &mut self.totals
    }

    fn run_clocks(&mut self, running: bool) {
        self.ws.run_clocks(running);
    }

    fn profile(&mut self) -> Profile {
        self.ws.profile()
    }
}
