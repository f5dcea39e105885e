//! The loop that takes a batch through a run, wherever it is stepped.

use super::energy::next_steps;
use super::progress::Progress;
use super::record::BatchRecorder;
use super::run::Run;
use super::start::narrow;
use anyhow::{Error, Result};
use clench::Batch;
use clench::rigid::Precision;
use clench::rigid::batch::Controls;
use std::ops::Range;

/// A run of a batch: how many steps it takes at a call, the controls that it is given and the record that it leaves.
pub(super) struct Rollout<'a, S> {
    run: &'a Run<'a>,
    /// The most steps of a call.
    most: usize,
    /// Steps between two rows of the record, if there is one.
    every: Option<usize>,
    recorder: Option<BatchRecorder>,
    controls: Option<Vec<S>>,
}

impl<'a, S: Precision> Rollout<'a, S> {
    /// A run that takes at most `most` steps at a call.
    ///
    /// # Errors
    /// A record that cannot be made.
    pub(super) fn new(run: &'a Run<'a>, envs: usize, most: usize) -> Result<Self> {
        let recorder = (run.record.as_ref())
            .map(|options| BatchRecorder::create(options, &run.model, envs))
            .transpose()?;
        Ok(Rollout {
            run,
            most,
            every: run.record.as_ref().map(|options| options.every),
            recorder,
            controls: run.controls.as_ref().map(|rows| narrow(rows.values())),
        })
    }

    /// Whether there is a record.
    pub(super) fn records(&self) -> bool {
        self.recorder.is_some()
    }

    /// Steps a batch until the run is over, no environment runs any more or a signal comes, and writes the record. `call` takes the
    /// steps of a range under controls and returns how many environments still run.
    ///
    /// # Errors
    /// That of `call`, with how many rows were recorded before: they are kept.
    pub(super) fn take(
        mut self,
        batch: &mut Batch<S>,
        mut call: impl FnMut(&mut Batch<S>, Range<usize>, Controls<S>) -> Result<usize>,
    ) -> Result<Taken> {
        let (run, nu) = (self.run, self.run.model.nu());
        let mut progress = Progress::new(run.steps);
        let (mut steps, mut running) = (0, batch.count());
        while steps < run.steps && running > 0 && run.interrupt.signal().is_none() {
            let range = next_steps(steps, run.steps, self.every, self.most);
            let (cells, end) = (steps * nu..range.end * nu, range.end);
            let ctrl = self.controls.as_ref().map(|rows| &rows[cells]);
            running = match call(batch, range, ctrl.map_or(Controls::Held, Controls::Shared)) {
                Ok(running) => running,
                Err(error) => return Err(self.keep(error)),
            };
            steps = end;
            if let Some(recorder) = &mut self.recorder {
                let held = batch.state.ctrl.row(0);
                let last = ctrl.map_or(held, |rows| &rows[rows.len() - nu..]);
                recorder.after_steps(steps, batch, last);
            }
            progress.reach(steps);
        }
        drop(progress);
        let recorded_rows = self.write();
        Ok(Taken {
            steps,
            recorded_rows,
        })
    }

    /// Writes what was recorded before an error, and says so with it.
    fn keep(self, error: Error) -> Error {
        match self.write() {
            Ok(Some(rows)) => error.context(format!("{rows} rows were recorded before the end")),
            Ok(None) => error,
            Err(second) => error.context(second),
        }
    }

    fn write(self) -> Result<Option<usize>> {
        self.recorder.map(BatchRecorder::write).transpose()
    }
}

/// What a run did.
pub(super) struct Taken {
    pub(super) steps: usize,
    /// Rows of the record, if there is one, or why it could not be written.
    pub(super) recorded_rows: Result<Option<usize>>,
}
