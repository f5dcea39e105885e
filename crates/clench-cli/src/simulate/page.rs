//! A record as a page that replays the run in a browser, without a server.

use super::messages::{self, MessageRecorder};
use super::record::{RecordOptions, Recorder};
use crate::message::print_message;
use crate::replacement::Replacement;
use anyhow::{Context, Result, bail};
use clench::rigid::Precision;
use clench::{Model, Sim};
use clench_view::{Marks, Page, RecordError, Recording, Scene};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// The file name extension of such a record.
const EXTENSION: &str = "html";

/// The record of one environment, in the format that its file name selects.
pub(crate) enum RunRecorder {
    /// NumPy arrays.
    Arrays(Recorder),
    /// An HTML page.
    Page(Box<PageRecorder>),
    /// MCAP messages.
    Messages(Box<MessageRecorder>),
}

impl RunRecorder {
    /// Creates an empty record.
    pub(crate) fn create(options: &RecordOptions, model: &Model) -> Result<Self> {
        let end = options.path.extension();
        let ends = |name: &str| end.is_some_and(|end| end.eq_ignore_ascii_case(name));
        if ends(EXTENSION) {
            let page = PageRecorder::create(options, model)?;
            return Ok(RunRecorder::Page(Box::new(page)));
        }
        if ends(messages::EXTENSION) {
            let messages = MessageRecorder::create(options, model)?;
            return Ok(RunRecorder::Messages(Box::new(messages)));
        }
        Recorder::create(options, model).map(RunRecorder::Arrays)
    }

    /// Appends the state after `steps` steps if it is due.
    pub(crate) fn after_steps<T: Precision>(
        &mut self,
        steps: usize,
        sim: &mut Sim<T>,
    ) -> Result<()> {
        match self {
            RunRecorder::Arrays(recorder) => recorder.after_steps(steps, sim),
            RunRecorder::Page(recorder) => recorder.after_steps(steps, sim)?,
            RunRecorder::Messages(recorder) => recorder.after_steps(steps, sim)?,
        }
        Ok(())
    }

    /// Writes the record and returns the number of its rows or frames.
    pub(crate) fn write(self) -> Result<usize> {
        match self {
            RunRecorder::Arrays(recorder) => recorder.write(),
            RunRecorder::Page(recorder) => recorder.write(),
            RunRecorder::Messages(recorder) => recorder.write(),
        }
    }
}

/// A page under construction.
pub(crate) struct PageRecorder {
    path: PathBuf,
    file: Replacement,
    page: Page,
    recording: Recording,
    every: usize,
    /// The reason if recording has stopped.
    full: Option<String>,
}

fn context(path: &Path) -> String {
    format!("--record {}", path.display())
}

impl PageRecorder {
    fn create(options: &RecordOptions, model: &Model) -> Result<Self> {
        let path = options.path.to_path_buf();
        let file = Replacement::begin(&path).with_context(|| context(&path))?;
        Ok(PageRecorder {
            page: Page::find(|text| print_message(text)).with_context(|| context(&path))?,
            recording: Recording::new(Scene::new(model), options.limit.bytes()),
            every: options.every,
            full: None,
            path,
            file,
        })
    }

    /// Records the state after `steps` steps if it is due. If the record has reached its memory limit, prints one
    /// message and lets the run continue.
    fn after_steps<T: Precision>(&mut self, steps: usize, sim: &mut Sim<T>) -> Result<()> {
        if !steps.is_multiple_of(self.every) || self.full.is_some() {
            return Ok(());
        }
        match self.recording.append(sim, &mut Marks::default()) {
            Ok(()) => Ok(()),
            Err(error @ RecordError::Sim(_)) => Err(error).with_context(|| context(&self.path)),
            Err(error @ RecordError::Full(..)) => {
                let context = context(&self.path);
                print_message(format_args!(
                    "warning: {context}: {error}, or raise --max-memory; what was recorded remains, the run continues"
                ));
                self.full = Some(error.to_string());
                Ok(())
            }
        }
    }

    fn write(self) -> Result<usize> {
        let write = || {
            let mut out = BufWriter::new(self.file.file()?);
            self.recording.write_html(&self.page, &mut out)?;
            self.file.finish()
        };
        write().with_context(|| context(&self.path))?;
        match self.full {
            Some(error) => bail!("{}: {error}", context(&self.path)),
            None => Ok(self.recording.len()),
        }
    }
}
