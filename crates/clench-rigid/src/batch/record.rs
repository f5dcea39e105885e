//! Recorded outputs of a batch, and rollouts that record outputs step by step.

use super::job::Call;
use super::recorded_states::RecordedStates;
use super::rows::try_reserve;
use super::targets::{Controls, OutputRows};
use super::{Batch, EnvStatus, Precision, Rows, Summary};
use crate::output::Output;
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use std::mem::{replace, swap};

/// The number of environment steps, and of steps, after which a rollout calls `go_on`: a fraction of a second.
const ENV_STEPS_A_PORTION: usize = 1 << 16;
const STEPS_A_PORTION: usize = 1 << 12;

/// The recorded outputs of a rollout.
#[derive(Debug)]
pub struct Recording<S> {
    outputs: Vec<OutputRows<S>>,
    steps: usize,
    /// The summary of the rollout.
    pub summary: Summary,
}

impl<S> Recording<S> {
    /// Returns a recorded output after each step (n, steps × width). Missing steps are NaN. Returns `None` if it was
    /// not recorded.
    pub fn get(&self, name: &str) -> Option<&Rows<S>> {
        find(&self.outputs, name)
    }
    /// Returns each recorded output with its table, in the layout of [`get`](Self::get).
    pub fn into_rows(self) -> impl Iterator<Item = (Output, Rows<S>)> {
        let outputs = self.outputs.into_iter();
        outputs.map(|own| (own.output, own.rows))
    }
    /// Returns the number of recorded steps.
    pub fn steps(&self) -> usize {
        self.steps
    }
}

fn find<'a, S>(outputs: &'a [OutputRows<S>], name: &str) -> Option<&'a Rows<S>> {
    let own = outputs.iter().find(|own| own.output.name() == name);
    own.map(|own| &own.rows)
}

impl<S: Precision> Batch<S> {
    /// Records these outputs, by their names in [`Output`], from now on, and no others. New ones are computed at once
    /// from the states of running environments. Every step and forward pass stores the values of its last forward pass
    /// in rows that [`output`](Self::output) returns. Rows of environments that do not run, or that fail, are
    /// unchanged, initially zero. Tables already recorded keep their address.
    ///
    /// # Errors
    /// Returns an error if a name is unknown or if memory is insufficient, or as [`forward`](Self::forward) does. The
    /// recorded outputs are then unchanged.
    pub fn record(&mut self, names: &[&str]) -> Result<(), SimError> {
        let requested = each_once(names)?;
        let mut new = requested.clone();
        new.retain(|output| self.outputs.iter().all(|own| own.output != *output));
        self.request(&new)?;
        let mut new = self.tables(&new, 1, S::ZERO)?;
        if !new.is_empty() {
            // New outputs are computed at once and separately: recorded ones do not change, and hold for the same
            // states as before.
            let first = match self.recorded {
                None => Some(RecordedStates::new(&self.model, self.count())?),
                Some(_) => None,
            };
            let before = replace(&mut self.recorded, first);
            swap(&mut self.outputs, &mut new);
            let computed = self.query(None);
            swap(&mut self.outputs, &mut new);
            if before.is_some() || computed.is_err() {
                self.recorded = before;
            }
            computed?;
        }
        self.outputs.retain(|own| requested.contains(&own.output));
        self.outputs.extend(new);
        if self.outputs.is_empty() {
            self.recorded = None;
        }
        Ok(())
    }

    /// Returns a recorded output (n, width); `None` if it is not recorded. Call [`refresh`](Self::refresh) first if
    /// states were written.
    pub fn output(&self, name: &str) -> Option<&Rows<S>> {
        find(&self.outputs, name)
    }

    /// Replaces the recorded outputs by those of a batch with the same states, so that a copy also has the outputs of
    /// the last step. `values` has all recorded outputs by name, each with its values environment by environment.
    ///
    /// # Errors
    /// Returns an error if an output is missing, or if a number of values is wrong. No output then changes.
    pub fn restore_outputs(&mut self, values: &[(&str, Vec<S>)]) -> Result<(), SimError> {
        check_length("outputs", values.len(), self.outputs.len())?;
        let found = |own: &OutputRows<S>| {
            let name = own.output.name();
            let given = values.iter().find(|(given, _)| *given == name);
            let given = given.map_or(&[][..], |(_, values)| values);
            check_length(name, given.len(), own.rows.as_slice().len()).map(|()| given)
        };
        let found = self.outputs.iter().map(found);
        let found = found.collect::<Result<Vec<_>, _>>()?;
        for (own, values) in self.outputs.iter_mut().zip(found) {
            own.rows.as_mut_slice().copy_from_slice(values);
        }
        if let Some(recorded) = &mut self.recorded {
            for env in 0..self.status.len() {
                recorded.record_row(env, &self.state);
            }
        }
        Ok(())
    }

    /// Advances every running environment by `steps` time steps and records outputs, by their names in [`Output`],
    /// after each. The controls override those in [`state`](Self::state), which do not change.
    ///
    /// # Errors
    /// Returns an error if a name is unknown, if the number of controls is wrong, if tables of `state` have wrong
    /// shapes, or if memory is insufficient.
    pub fn rollout(
        &mut self,
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
    ) -> Result<Recording<S>, SimError> {
        self.rollout_while(None, steps, controls, record, |_| true)
    }

    /// Runs a [`rollout`](Self::rollout) of all environments from initial states. `initial` holds time, positions,
    /// velocities and activations, environment by environment (n, 1 + nq + nv + na). The solver starts without warm
    /// start, so that no earlier step affects the results. All else, such as applied forces, mocap poses, switches and
    /// plastic deformation of springs, is as in [`state`](Self::state).
    ///
    /// # Errors
    /// Returns an error as [`rollout`](Self::rollout) does, or if the number of initial values is wrong; the states are
    /// then unchanged.
    pub fn rollout_from(
        &mut self,
        initial: &[S],
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
    ) -> Result<Recording<S>, SimError> {
        self.rollout_while(Some(initial), steps, controls, record, |_| true)
    }

    /// Runs a [`rollout`](Self::rollout), optionally from initial states, while `go_on` returns true. `go_on` is called
    /// at intervals with the number of completed steps. Missing steps are NaN.
    ///
    /// # Errors
    /// See [`rollout_from`](Self::rollout_from).
    pub fn rollout_while(
        &mut self,
        initial: Option<&[S]>,
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
        mut go_on: impl FnMut(usize) -> bool,
    ) -> Result<Recording<S>, SimError> {
        self.check_state()?;
        self.check_threads()?;
        if let Some(initial) = initial {
            check_length("initial", initial.len(), self.count() * self.moving())?;
        }
        let mut outputs = self.recorder(steps, controls, record)?;
        if let Some(initial) = initial {
            self.start_from(initial);
        }
        let portion = (ENV_STEPS_A_PORTION / self.count().max(1)).clamp(1, STEPS_A_PORTION);
        let (mut failed, mut resets, mut first) = (0, 0, 0_usize);
        let summary = loop {
            let range = first..steps.min(first.saturating_add(portion));
            first = range.end;
            let call = Call {
                range,
                controls,
                ..Call::steps(steps)
            };
            let part = self.run(&call, &mut outputs)?;
            failed += part.failed;
            resets += part.resets;
            if first == steps || part.running == 0 || !go_on(first) {
                break Summary {
                    failed,
                    resets,
                    ..part
                };
            }
        };
        Ok(Recording {
            outputs,
            steps,
            summary,
        })
    }

    /// Returns the number of values of an environment's initial state.
    fn moving(&self) -> usize {
        1 + self.model.nq + self.model.nv + self.model.na
    }

    /// Starts all environments from these states of [`moving`](Self::moving) values each.
    fn start_from(&mut self, initial: &[S]) {
        let (nq, nv) = (self.model.nq, self.model.nv);
        let (motion, _) = self.state.share();
        for (env, row) in initial
            .chunks_exact(1 + nq + nv + self.model.na)
            .enumerate()
        {
            motion.start(env, row, nq, nv);
        }
        self.status.fill(EnvStatus::Running);
    }

    /// Allocates the tables of a rollout after checking the number of controls.
    fn recorder(
        &mut self,
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
    ) -> Result<Vec<OutputRows<S>>, SimError> {
        let (n, row) = (self.count(), steps.saturating_mul(self.model.nu()));
        match controls {
            Controls::Held => {}
            Controls::Shared(values) => check_length("ctrl", values.len(), row)?,
            Controls::Each(values) => check_length("ctrl", values.len(), n.saturating_mul(row))?,
        }
        let record = each_once(record)?;
        self.request(&record)?;
        self.tables(&record, steps, S::new(f64::NAN))
    }

    /// Lets the device of this batch, if there is one, compute these outputs.
    fn request(&mut self, outputs: &[Output]) -> Result<(), SimError> {
        (self.mirror.as_mut()).map_or(Ok(()), |mirror| mirror.request(outputs))
    }

    /// Allocates tables for outputs with rows of `steps` steps.
    fn tables(
        &self,
        outputs: &[Output],
        steps: usize,
        filler: S,
    ) -> Result<Vec<OutputRows<S>>, SimError> {
        let n = self.count();
        let width = |output: Output| steps.saturating_mul(output.width(&self.model));
        let bytes = outputs
            .iter()
            .map(|&o| width(o).saturating_mul(size_of::<S>()));
        try_reserve(n, bytes.fold(0, usize::saturating_add))?;
        let table = |&output: &Output| {
            let rows = Rows::new(n, width(output), filler)?;
            Ok(OutputRows { output, rows })
        };
        outputs.iter().map(table).collect()
    }
}

/// Returns the outputs of these names without duplicates.
fn each_once(names: &[&str]) -> Result<Vec<Output>, SimError> {
    let mut outputs = Vec::new();
    for name in names {
        let output = Output::find(name)?;
        if !outputs.contains(&output) {
            outputs.push(output);
        }
    }
    Ok(outputs)
}
