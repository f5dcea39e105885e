//! Outputs that a batch keeps, and rollouts that record them step by step.

use super::job::Call;
use super::recorded_states::RecordedStates;
use super::rows::try_reserve;
use super::targets::{Controls, OutputRows};
use super::{Batch, EnvStatus, Precision, Rows, Summary};
use crate::output::Output;
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use std::mem::{replace, swap};

/// So many steps of environments, and so many steps, are done before a rollout asks whether to go on: a fraction of a second.
const ENV_STEPS_A_PORTION: usize = 1 << 16;
const STEPS_A_PORTION: usize = 1 << 12;

/// What a rollout recorded.
#[derive(Debug)]
pub struct Recording<S> {
    outputs: Vec<OutputRows<S>>,
    steps: usize,
    /// What the rollout did.
    pub summary: Summary,
}

impl<S> Recording<S> {
    /// A recorded output (n, steps × width), after each step; steps that an environment did not do are NaN. `None` if it
    /// was not recorded.
    pub fn get(&self, name: &str) -> Option<&Rows<S>> {
        find(&self.outputs, name)
    }
    /// What was recorded, each output with its table as [`get`](Self::get) shows it.
    pub fn into_rows(self) -> impl Iterator<Item = (Output, Rows<S>)> {
        let outputs = self.outputs.into_iter();
        outputs.map(|own| (own.output, own.rows))
    }
    /// How many steps were recorded.
    pub fn steps(&self) -> usize {
        self.steps
    }
}

fn find<'a, S>(outputs: &'a [OutputRows<S>], name: &str) -> Option<&'a Rows<S>> {
    let own = outputs.iter().find(|own| own.output.name() == name);
    own.map(|own| &own.rows)
}

impl<S: Precision> Batch<S> {
    /// Keeps these outputs, by the names in [`Output`], from now on, and no others. Those that are new are computed at once from
    /// the states of running environments. Every step and forward leaves them as of its last forward pass, in rows that
    /// [`output`](Self::output) shows; for environments that do not run, and those that fail, rows stay as they are, zero at
    /// first. Tables of outputs that were kept before stay where they are.
    ///
    /// # Errors
    /// A name that no output has; more memory than there is; else as [`forward`](Self::forward). What is kept is then as before.
    pub fn record(&mut self, names: &[&str]) -> Result<(), SimError> {
        let wanted = each_once(names)?;
        let mut new = wanted.clone();
        new.retain(|output| self.outputs.iter().all(|own| own.output != *output));
        self.want(&new)?;
        let mut new = self.tables(&new, 1, S::ZERO)?;
        if !new.is_empty() {
            // What is new is computed at once and by itself: what was kept before stays as it is, and holds for what it held.
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
        self.outputs.retain(|own| wanted.contains(&own.output));
        self.outputs.extend(new);
        if self.outputs.is_empty() {
            self.recorded = None;
        }
        Ok(())
    }

    /// An output that is kept (n, width); `None` if it is not. [`refresh`](Self::refresh) first where states were written.
    pub fn output(&self, name: &str) -> Option<&Rows<S>> {
        find(&self.outputs, name)
    }

    /// Advances every running environment by `steps` time steps and records outputs, by the names in [`Output`], after each.
    /// The controls go before those in [`state`](Self::state), which stay as they are.
    ///
    /// # Errors
    /// A name that no output has, a wrong number of controls, tables of `state` that are not those of this batch, more
    /// memory than there is.
    pub fn rollout(
        &mut self,
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
    ) -> Result<Recording<S>, SimError> {
        self.rollout_while(None, steps, controls, record, |_| true)
    }

    /// As [`rollout`](Self::rollout), with all environments running from states of which `initial` holds what moves, environment
    /// after environment (n, 1 + nq + nv + na): time, positions, velocities, activations. The solver starts anew, so that what
    /// comes out depends on no earlier step; all else, such as applied forces, mocap poses, switches, and where springs that yield rest, is
    /// as [`state`](Self::state) has it.
    ///
    /// # Errors
    /// As [`rollout`](Self::rollout), and a wrong number of initial numbers; the states are then as before.
    pub fn rollout_from(
        &mut self,
        initial: &[S],
        steps: usize,
        controls: Controls<S>,
        record: &[&str],
    ) -> Result<Recording<S>, SimError> {
        self.rollout_while(Some(initial), steps, controls, record, |_| true)
    }

    /// A [`rollout`](Self::rollout), or one from given states, that goes on only as long as `go_on` says, which is asked every
    /// now and then and given the number of steps done. Steps that are not done are NaN.
    ///
    /// # Errors
    /// As [`rollout_from`](Self::rollout_from).
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

    /// How many numbers of an environment's state move.
    fn moving(&self) -> usize {
        1 + self.model.nq + self.model.nv + self.model.na
    }

    /// Lets all environments run from these states, of which [`moving`](Self::moving) numbers are given.
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

    /// Room for what a rollout records, once its controls are as many as they must be.
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
        self.want(&record)?;
        self.tables(&record, steps, S::new(f64::NAN))
    }

    /// Lets the device of this batch, if it has one, compute these outputs.
    ///
    /// # Errors
    /// Outputs that it does not compute.
    fn want(&mut self, outputs: &[Output]) -> Result<(), SimError> {
        (self.mirror.as_mut()).map_or(Ok(()), |mirror| mirror.want(outputs))
    }

    /// Tables for outputs, where a row has room for `steps` steps.
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

/// The outputs of these names, each once.
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
