//! A run as an MCAP file, which Foxglove shows and whose messages many tools of robotics read.
//!
//! Poses, shapes and forces are Foxglove's own messages, encoded in JSON; what is plotted comes as JSON objects with a schema
//! each. The log time is the simulated one. Shapes are told once, in the frames of their bodies; poses and forces with every
//! frame. Chunks are written whole, so a file that was cut off can be read up to the last of them.

mod channels;
mod file;
mod messages;
mod shapes;

use channels::{Channel, channels};
use clench::rigid::{Precision, Sim};
use clench::{Model, SimError};
use file::{McapFile, Stream};
use messages::{Moment, frame_names};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::time::{Duration, Instant};

/// What has been recorded reaches the file after so long at the latest.
const FLUSH: Duration = Duration::from_secs(1);

/// Why a frame could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum McapRecordError {
    /// The simulation has no frame to give.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The file takes no more.
    #[error(transparent)]
    File(#[from] io::Error),
}

/// Writes what happens in a simulation to a file, moment by moment.
pub struct McapRecorder<W: Write> {
    file: McapFile<W>,
    channels: Vec<Channel>,
    frames: Vec<String>,
    /// How many moments there are.
    moments: usize,
    flushed: Instant,
    /// Metres a newton, of arrows.
    scale: f64,
}

impl<W: Write> McapRecorder<W> {
    /// A recording of a model without any moment yet.
    ///
    /// # Errors
    /// A file that takes nothing.
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

    /// How many moments there are.
    pub fn len(&self) -> usize {
        self.moments
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.moments == 0
    }

    /// Records what is now. Times before 0 are told as 0: MCAP has none.
    ///
    /// # Errors
    /// A state that cannot be evaluated; a file that takes no more. Nothing can be recorded after the latter.
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

    /// Writes what is not in the file yet and the index of all.
    ///
    /// # Errors
    /// A file that takes no more.
    pub fn finish(mut self) -> Result<(), McapRecordError> {
        Ok(self.file.finish()?)
    }
}

/// A time as Foxglove's messages have it.
fn time(nanoseconds: u64) -> Value {
    json!({"sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000})
}
