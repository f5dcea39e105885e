//! Steps on a device. Rows written since the last call are uploaded, results are downloaded, and the device's reports
//! become statuses, times and resets. Resets, snapshots and queries use the rows, as without a device.

use super::backend::{Backend, Outcome, StepFailure};
use super::job::{Call, Pass};
use super::mirror::Mirror;
use super::rows::per_env;
use super::targets::OutputRows;
use super::{Batch, BatchOptions, Controls, EnvStatus, Precision, StateRows, Summary};
use crate::output::Output;
use clench_dynamics::check::{beyond_bounds, input_fault};
use clench_dynamics::error::{Fault, SimError};
use clench_dynamics::joint_description::joint_of;
use clench_dynamics::model::{Model, Sensor, SensorKind};
use clench_dynamics::state::FIELDS;
use std::mem::{swap, take};
use std::sync::Arc;

/// The number of values that are compared between tests of the result.
const BLOCK: usize = 256;

/// Returns true if two arrays have the same bits: −0, which wakes trees, differs from 0.
fn same_bits<S: Precision>(one: &[S], other: &[S]) -> bool {
    let bits = |x: &S| x.to_f64().to_bits();
    let same = |same: bool, (a, b): (&S, &S)| same & (bits(a) == bits(b));
    let mut blocks = one.chunks(BLOCK).zip(other.chunks(BLOCK));
    one.len() == other.len() && blocks.all(|(a, b)| a.iter().zip(b).fold(true, same))
}

impl<S: Precision> Batch<S> {
    /// Creates `count` environments in the model's initial state that `backend` steps; its own environments may be in
    /// any state. Outputs can be recorded if the device computes them or they follow from the rows. The options are
    /// those that `backend` was created with. [`quality`](Self::quality), [`divergence`](Self::divergence) and
    /// [`profile`](Self::profile) stay zero, as they cover only steps on the CPU.
    ///
    /// # Errors
    /// See [`with_options`](Self::with_options).
    pub fn with_backend(
        model: Arc<Model>,
        count: usize,
        options: BatchOptions,
        backend: Box<dyn Backend<S>>,
    ) -> Result<Self, SimError> {
        let mut batch = Batch::with_options(model, count, options)?;
        let mut mirror = Mirror {
            backend,
            fields: Vec::new(),
            running: per_env(count, || false)?,
            restarted: per_env(count, || false)?,
            outcomes: per_env(count, Outcome::default)?,
            numbers: Vec::new(),
            sim: None,
        };
        for field in FIELDS {
            let mut numbers = Vec::new();
            batch.state.read_field(field.name, &mut numbers);
            if mirror.backend.holds(field.name) {
                mirror.backend.write(field.name, &numbers)?;
            }
            mirror.fields.push(numbers);
        }
        batch.mirror = Some(mirror);
        Ok(batch)
    }

    /// Returns the name of the device that steps the environments, or `None` for the CPU.
    pub fn device(&self) -> Option<String> {
        self.mirror.as_ref().map(Mirror::name)
    }

    /// Returns an error if the batch is on a device, where `what` cannot change.
    pub(super) fn check_changeable(&self, what: &'static str) -> Result<(), SimError> {
        match &self.mirror {
            None => Ok(()),
            Some(mirror) => Err(SimError::Backend(format!(
                "{what} of a batch on {} cannot be changed yet: they are fixed when it is created",
                mirror.name()
            ))),
        }
    }

    /// Returns an error if the batch is on a device that does not hold a field of the state.
    pub(super) fn check_held(&self, field: &'static str) -> Result<(), SimError> {
        self.mirror
            .as_ref()
            .map_or(Ok(()), |mirror| mirror.check_held(field))
    }

    /// Runs a call on the device.
    pub(super) fn run_on_device(
        &mut self,
        mirror: &mut Mirror<S>,
        call: &Call<S>,
        trace: &mut [OutputRows<S>],
    ) -> Result<Summary, SimError> {
        let mut summary = Summary {
            failed: 0,
            running: 0,
            resets: 0,
        };
        mirror.restarted.fill(false);
        for (env, runs) in mirror.running.iter_mut().enumerate() {
            let chosen = call.mask.is_none_or(|mask| mask[env]);
            *runs = chosen && self.status[env] == EnvStatus::Running;
        }
        let may_restart = self.settings.autoreset && call.pass == Pass::Step;
        self.upload(mirror, call.pass, may_restart, &mut summary)?;
        if mirror.restarted.contains(&true) {
            self.start_over(mirror, &mut summary)?;
        }
        let constant_controls = matches!(call.controls, Controls::Held);
        // The rounded time determines when a sensor with a period is due, so every step gets its own time.
        let periods = &self.model.params.sensor_interval;
        let timed = periods.iter().any(|&period| period > 0.0);
        let is_uniform = constant_controls && trace.is_empty() && !timed;
        let mut step = call.range.start;
        while step < call.range.end && mirror.running.contains(&true) {
            let count = if is_uniform { call.range.end - step } else { 1 };
            self.control(mirror, call, step)?;
            self.advance(mirror, call.pass, (count, constant_controls), &mut summary)?;
            step += count;
            if !trace.is_empty() {
                self.download(mirror, call.pass)?;
            }
            for own in trace.iter_mut() {
                self.fetch(mirror, own, step - 1)?;
            }
        }
        self.download(mirror, call.pass)?;
        if step == call.steps {
            self.fetch_recorded(mirror)?;
        }
        let running = |status: &&EnvStatus| **status == EnvStatus::Running;
        summary.running = self.status.iter().filter(running).count();
        Ok(summary)
    }

    /// Uploads the fields that were written since the last call. An environment with an invalid state fails.
    fn upload(
        &mut self,
        mirror: &mut Mirror<S>,
        pass: Pass,
        may_restart: bool,
        summary: &mut Summary,
    ) -> Result<(), SimError> {
        for env in 0..mirror.running.len() {
            if mirror.running[env] && !self.state.time.row(env)[0].is_finite() {
                self.refuse(mirror, env, pass, may_restart, summary)?;
            }
        }
        for (k, field) in FIELDS.iter().enumerate() {
            self.state.read_field(field.name, &mut mirror.numbers);
            if same_bits(&mirror.numbers, &mirror.fields[k]) {
                continue;
            }
            mirror.check_held(field.name)?;
            swap(&mut mirror.numbers, &mut mirror.fields[k]);
            let width = field.numbers(&self.model);
            for env in 0..mirror.running.len() {
                let row = &mirror.fields[k][env * width..][..width];
                if mirror.running[env] && beyond_bounds(field.name, row) {
                    self.refuse(mirror, env, pass, may_restart, summary)?;
                }
            }
            mirror.backend.write(field.name, &mirror.fields[k])?;
        }
        Ok(())
    }

    /// Marks an environment with an invalid state as failed.
    fn refuse(
        &mut self,
        mirror: &mut Mirror<S>,
        env: usize,
        pass: Pass,
        may_restart: bool,
        summary: &mut Summary,
    ) -> Result<(), SimError> {
        self.state.read(env, &mut self.scratch)?;
        let fault = input_fault(&self.model, &self.scratch, 0);
        mirror.running[env] = false;
        if may_restart {
            mirror.restarted[env] = true;
        } else if pass != Pass::Query {
            self.status[env] = EnvStatus::Failed(fault);
            summary.failed += 1;
        }
        Ok(())
    }

    /// Uploads the controls of a rollout's step.
    fn control(
        &mut self,
        mirror: &mut Mirror<S>,
        call: &Call<S>,
        step: usize,
    ) -> Result<(), SimError> {
        let nu = self.model.nu();
        let Some(ctrl) = FIELDS.iter().position(|field| field.name == "ctrl") else {
            return Ok(());
        };
        let fields = &mut mirror.fields[ctrl];
        for env in 0..self.status.len() {
            match call.controls.row(env, step, call.steps, nu) {
                Some(row) => fields[env * nu..][..nu].copy_from_slice(row),
                None => return Ok(()),
            }
        }
        mirror.backend.write("ctrl", fields)
    }

    /// Runs `count` steps or a forward pass, and records which environments failed or were reset; those keep their
    /// controls unless these are constant.
    fn advance(
        &mut self,
        mirror: &mut Mirror<S>,
        pass: Pass,
        (count, constant_controls): (usize, bool),
        summary: &mut Summary,
    ) -> Result<(), SimError> {
        let reads_time = |s: &Sensor| s.kind == SensorKind::Clock || s.history.is_some();
        let is_read = self.model.sensors.iter().any(reads_time);
        if is_read && mirror.backend.holds("start_time") {
            let times = self.state.time.as_slice().iter();
            mirror.numbers.clear();
            mirror.numbers.extend(times.map(|&time| S::new(time)));
            mirror.backend.write("start_time", &mirror.numbers)?;
        }
        let (running, outcomes) = (&mirror.running, &mut mirror.outcomes);
        match pass {
            Pass::Step => {
                (mirror.backend).step(count, !constant_controls, running, outcomes)?;
            }
            Pass::Forward | Pass::Query => mirror.backend.forward(running, outcomes)?,
        }
        let mut any_restarted = false;
        for env in 0..mirror.running.len() {
            if !mirror.running[env] {
                continue;
            }
            let outcome = mirror.outcomes[env];
            any_restarted |= outcome.restarted;
            if outcome.restarted {
                self.state.write(env, self.models.initial(env))?;
                self.resets[env] += outcome.resets as u64;
                summary.resets += outcome.resets;
            }
            let clock = &mut self.state.time.row_mut(env)[0];
            // Accumulated with the same rounding as on the CPU.
            let timestep = S::new(self.model.params.timestep).to_f64();
            (0..outcome.steps).for_each(|_| *clock += timestep);
            let time = *clock;
            let Some(failure) = outcome.failure else {
                continue;
            };
            mirror.running[env] = false;
            if pass != Pass::Query {
                self.status[env] = EnvStatus::Failed(self.fault(failure, time));
                summary.failed += 1;
            }
        }
        if any_restarted {
            self.follow_resets(mirror, constant_controls);
        }
        Ok(())
    }

    /// Copies the inputs that the device has reset.
    fn follow_resets(&mut self, mirror: &mut Mirror<S>, constant_controls: bool) {
        for (field, numbers) in FIELDS.iter().zip(&mut mirror.fields) {
            let is_input = !StateRows::<S>::MOVING.contains(&field.name);
            if is_input && (constant_controls || field.name != "ctrl") {
                self.state.read_field(field.name, numbers);
            }
        }
    }

    fn fault(&self, failure: StepFailure, time: f64) -> Fault {
        match failure {
            StepFailure::Singular => Fault::Singular { time, place: None },
            StepFailure::Unfinished => Fault::Unfinished { time },
            StepFailure::ContactOverflow { limit } => Fault::ContactOverflow { time, limit },
            StepFailure::OverBudget(excess) => {
                let (what, limit, remedy) = excess.describe(&self.model);
                Fault::OverBudget {
                    time,
                    what,
                    limit,
                    remedy,
                }
            }
            StepFailure::Diverged {
                field,
                index,
                value,
            } => Fault::Diverged {
                time,
                field,
                index,
                value,
                place: joint_of(&self.model, field, index),
            },
        }
    }

    /// Begins environments with an invalid state in the initial one.
    fn start_over(
        &mut self,
        mirror: &mut Mirror<S>,
        summary: &mut Summary,
    ) -> Result<(), SimError> {
        for env in (0..mirror.running.len()).filter(|&env| mirror.restarted[env]) {
            self.state.write(env, self.models.initial(env))?;
            mirror.running[env] = true;
            self.resets[env] += 1;
            summary.resets += 1;
        }
        self.upload(mirror, Pass::Step, false, summary)
    }

    /// Downloads the fields that steps change.
    fn download(&mut self, mirror: &mut Mirror<S>, pass: Pass) -> Result<(), SimError> {
        if pass != Pass::Step {
            return Ok(());
        }
        for (field, numbers) in FIELDS.iter().zip(&mut mirror.fields) {
            let moves = StateRows::<S>::MOVING.contains(&field.name);
            if !moves || numbers.is_empty() || !mirror.backend.holds(field.name) {
                continue;
            }
            mirror.backend.read(field.name, numbers)?;
            self.state.write_field(field.name, numbers);
        }
        Ok(())
    }

    /// Copies the recorded outputs.
    fn fetch_recorded(&mut self, mirror: &mut Mirror<S>) -> Result<(), SimError> {
        let mut outputs = take(&mut self.outputs);
        let mut own_outputs = outputs.iter_mut();
        let fetched = own_outputs.try_for_each(|own| self.fetch(mirror, own, 0));
        self.outputs = outputs;
        if let Some(recorded) = &mut self.recorded {
            let ran = mirror.running.iter().enumerate().filter(|(_, runs)| **runs);
            ran.for_each(|(env, _)| recorded.record_row(env, &self.state));
        }
        fetched
    }

    /// Computes the energies of the running environments from their states on the host.
    fn energies(&mut self, mirror: &mut Mirror<S>) -> Result<(), SimError> {
        for env in (0..mirror.running.len()).filter(|&env| mirror.running[env]) {
            let sim = match &mut mirror.sim {
                Some(sim) => sim,
                none => none.insert(Box::new(self.sim(env)?)),
            };
            self.state.read(env, &mut sim.state)?;
            self.copy_params(env, sim);
            let energy = sim.energy()?;
            mirror.numbers[2 * env..][..2].copy_from_slice(&[energy.potential, energy.kinetic]);
        }
        Ok(())
    }

    /// Copies an output of the running environments into its rows, at step `step`.
    fn fetch(
        &mut self,
        mirror: &mut Mirror<S>,
        own: &mut OutputRows<S>,
        step: usize,
    ) -> Result<(), SimError> {
        let width = own.output.width(&self.model);
        mirror.numbers.clear();
        mirror.numbers.resize(width * self.status.len(), S::ZERO);
        match own.output {
            Output::time => {
                let times = self.state.time.as_slice().iter();
                let rounded = times.map(|&time| S::new(time));
                mirror
                    .numbers
                    .iter_mut()
                    .zip(rounded)
                    .for_each(|(to, time)| *to = time);
            }
            output if output.is_state() => {
                self.state.read_field(output.name(), &mut mirror.numbers);
            }
            Output::energy => self.energies(mirror)?,
            output => mirror.backend.read_output(output, &mut mirror.numbers)?,
        }
        let rows = mirror.numbers.chunks_exact(width.max(1)).enumerate();
        for (env, row) in rows.filter(|&(env, _)| mirror.running[env]) {
            own.rows.row_mut(env)[step * width..][..width].copy_from_slice(row);
        }
        Ok(())
    }
}
