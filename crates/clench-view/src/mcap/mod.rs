//! Recordings of runs as MCAP files, which Foxglove shows and many robotics tools read.
//!
//! Poses, shapes and forces are Foxglove messages, encoded in JSON; plotted values are JSON objects with a schema each.
//! The log time is the simulated time. Shapes are written once, in the frames of their bodies; poses and forces with
//! every frame. Chunks are written whole, so a truncated file can be read up to its last complete chunk.

mod channels;
mod file;
mod messages;
mod record;
mod shapes;

use channels::{Channel, channels};
use clench::rigid::{Precision, Sim};
use clench::{Model, SimError};
use file::{McapFile, Stream};
use messages::{Moment, frame_names};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::time::{Duration, Instant};

/// The maximum interval between flushes to the file.
const FLUSH: Duration = Duration::from_secs(1);

/// An error of recording a frame.
#[derive(Debug, thiserror::Error)]
pub enum McapRecordError {
    /// The state of the simulation cannot be evaluated.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] io::Error),
}

/// Records a simulation to a file, frame by frame.
pub struct McapRecorder<W: Write> {
    file: McapFile<W>,
    channels: Vec<Channel>,
    frames: Vec<String>,
    /// The number of recorded frames.
    moments: usize,
    flushed: Instant,
    /// The length of arrows, m/N.
    scale: f64,
}

impl<W: Write> McapRecorder<W> {
    /// Creates a recording of a model without frames.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn new(to: W, model: &Model) -> Result<Self, McapRecordError> {
        let channels = channels(model);
        let stream = |channel: &Channel| Stream {
            topic: channel.topic,
            schema_name: channel.schema_name,
            schema: serde_json::to_vec(&channel.schema).unwrap_or_default(),
        };
        let streams: Vec<Stream> = channels.iter().map(stream).collect();
        let library = concat!("clench ", env!("CARGO_PKG_VERSION"));
        Ok(McapRecorder {
            file: McapFile::new(to, library, &streams)?,
            channels,
            frames: frame_names(model),
            moments: 0,
            flushed: Instant::now(),
            scale: messages::force_scale(model),
        })
    }

    /// Returns the number of recorded frames.
    pub fn len(&self) -> usize {
        self.moments
    }
    /// Returns true if there is no frame.
    pub fn is_empty(&self) -> bool {
        self.moments == 0
    }

    /// Records the present state. Negative times are recorded as 0: MCAP has none.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated or the file cannot be written. Nothing can be recorded after
    /// the latter.
    pub fn append<T: Precision>(&mut self, sim: &mut Sim<T>) -> Result<(), McapRecordError> {
        sim.refresh()?;
        let energy = sim.energy()?;
        let pushes = sim.pushes()?;
        let moment = Moment {
            sim,
            energy: [energy.potential.to_f64(), energy.kinetic.to_f64()],
            pushes: &pushes,
            frames: &self.frames,
            scale: self.scale,
        };
        let nanoseconds = (1e9 * moment.sim.state.time).round() as u64;
        for (id, channel) in (0..).zip(&self.channels) {
            if channel.once && self.moments > 0 {
                continue;
            }
            let message = channel.message.message(&moment, &time(nanoseconds));
            let bytes = serde_json::to_vec(&message).unwrap_or_default();
            let sequence = self.moments as u32;
            self.file.message(id, sequence, nanoseconds, &bytes)?;
        }
        self.moments += 1;
        if self.flushed.elapsed() >= FLUSH {
            self.file.flush()?;
            self.flushed = Instant::now();
        }
        Ok(())
    }

    /// Writes pending messages and the index.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(mut self) -> Result<(), McapRecordError> {
        Ok(self.file.finish()?)
    }
}

/// Converts a time to the format of Foxglove's messages.
fn time(nanoseconds: u64) -> Value {
    json!({"sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000})
}
