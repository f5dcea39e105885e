//! The loop of a batch run, independent of the device that steps it.

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

/// A batch run: the number of steps per call, the controls and the record.
pub(super) struct Rollout<'a, S> {
    run: &'a Run<'a>,
    /// The maximum number of steps of a call.
    max_steps: usize,
    /// The number of steps between rows of the record, if there is one.
    every: Option<usize>,
    recorder: Option<BatchRecorder>,
    controls: Option<Vec<S>>,
}

impl<'a, S: Precision> Rollout<'a, S> {
    /// Prepares a run that takes at most `max_steps` steps per call.
    ///
    /// # Errors
    /// Returns an error if the record cannot be created.
    pub(super) fn new(run: &'a Run<'a>, envs: usize, max_steps: usize) -> Result<Self> {
        let recorder = (run.record.as_ref())
            .map(|options| BatchRecorder::create(options, &run.model, envs))
            .transpose()?;
        Ok(Rollout {
            run,
            max_steps,
            every: run.record.as_ref().map(|options| options.every),
            recorder,
            controls: run.controls.as_ref().map(|rows| narrow(rows.values())),
        })
    }

    /// Returns true if there is a record.
    pub(super) fn records(&self) -> bool {
        self.recorder.is_some()
    }

    /// Steps a batch until the run is complete, no environment is running or a signal arrives, and writes the record.
    /// `call` takes the steps of a range with the controls and returns the number of running environments.
    ///
    /// # Errors
    /// Returns the error of `call` with the number of rows recorded before, which are written.
    pub(super) fn run(
        mut self,
        batch: &mut Batch<S>,
        mut call: impl FnMut(&mut Batch<S>, Range<usize>, Controls<S>) -> Result<usize>,
    ) -> Result<RunResult> {
        let (run, nu) = (self.run, self.run.model.nu());
        let mut progress = Progress::new(run.steps);
        let (mut steps, mut running) = (0, batch.count());
        while steps < run.steps && running > 0 && run.interrupt.signal().is_none() {
            let range = next_steps(steps, run.steps, self.every, self.max_steps);
            let (cells, end) = (steps * nu..range.end * nu, range.end);
            let ctrl = self.controls.as_ref().map(|rows| &rows[cells]);
            running = match call(batch, range, ctrl.map_or(Controls::Held, Controls::Shared)) {
                Ok(running) => running,
                Err(error) => return Err(self.write_before(error)),
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
        Ok(RunResult {
            steps,
            recorded_rows,
        })
    }

    /// Writes the rows recorded before an error, and adds their number to the error.
    fn write_before(self, error: Error) -> Error {
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

/// The result of a run.
pub(super) struct RunResult {
    pub(super) steps: usize,
    /// The number of rows of the record, if there is one, or the error of writing it.
    pub(super) recorded_rows: Result<Option<usize>>,
}
