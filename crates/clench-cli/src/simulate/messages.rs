//! An MCAP record: messages that are written during the run.

use super::record::RecordOptions;
use crate::message::print_message;
use anyhow::{Context, Result, bail};
use clench::rigid::Precision;
use clench::{Model, Sim};
use clench_view::McapRecorder;
use clench_view::mcap::McapRecordError;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// The file name extension of such a record.
pub(crate) const EXTENSION: &str = "mcap";

/// An MCAP file under construction at its final path: it can be read even if the program is killed.
pub(crate) struct MessageRecorder {
    path: PathBuf,
    recorder: McapRecorder<BufWriter<File>>,
    every: usize,
    /// The reason if the file can no longer be written.
    full: Option<String>,
}

fn context(path: &Path) -> String {
    format!("--record {}", path.display())
}

impl MessageRecorder {
    /// Creates an empty record, replacing an old one.
    pub(crate) fn create(options: &RecordOptions, model: &Model) -> Result<Self> {
        let path = options.path.to_path_buf();
        let file = File::create(&path).with_context(|| context(&path))?;
        let recorder = McapRecorder::new(BufWriter::new(file), model);
        Ok(MessageRecorder {
            recorder: recorder.with_context(|| context(&path))?,
            every: options.every,
            full: None,
            path,
        })
    }

    /// Records the state after `steps` steps if it is due. If the file cannot be written, prints one message and lets
    /// the run continue.
    pub(crate) fn after_steps<T: Precision>(
        &mut self,
        steps: usize,
        sim: &mut Sim<T>,
    ) -> Result<()> {
        if !steps.is_multiple_of(self.every) || self.full.is_some() {
            return Ok(());
        }
        match self.recorder.append(sim) {
            Ok(()) => Ok(()),
            Err(error @ McapRecordError::Sim(_)) => Err(error).with_context(|| context(&self.path)),
            Err(error @ McapRecordError::File(_)) => {
                let moments = self.recorder.len();
                let context = context(&self.path);
                print_message(format_args!(
                    "warning: {context}: {error}; nothing is recorded after {moments} frames, the run continues"
                ));
                self.full = Some(error.to_string());
                Ok(())
            }
        }
    }

    /// Writes the remaining data and returns the number of moments.
    pub(crate) fn write(self) -> Result<usize> {
        let moments = self.recorder.len();
        if let Some(error) = self.full {
            bail!("{}: {error}", context(&self.path));
        }
        (self.recorder.finish()).with_context(|| context(&self.path))?;
        Ok(moments)
    }
}
