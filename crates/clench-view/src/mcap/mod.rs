//! A run as an MCAP file, which Foxglove shows and whose messages many tools of robotics read.
//!
//! Poses, shapes and forces are Foxglove's own messages, encoded in JSON; what is plotted comes as JSON objects with a schema
//! each. The log time is the simulated one. Shapes are told once, in the frames of their bodies; poses and forces with every
//! frame. Chunks are written whole, so a file that was cut off can be read up to the last of them.

mod channels;
mod messages;
mod shapes;

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{McapError, WriteOptions, Writer};
use channels::{Channel, channels};
use clench::rigid::{Precision, Sim};
use clench::{Model, SimError};
use messages::{Moment, frame_names};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
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
    #[error("{}", said(.0))]
    File(#[from] McapError),
}

/// What a file said: the system's own words, where there are any.
fn said(error: &McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        error => error.to_string(),
    }
}

/// Writes what happens in a simulation to a file, moment by moment.
pub struct McapRecorder<W: Write> {
    writer: Writer<NoSeek<W>>,
    channels: Vec<(Channel, u16)>,
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
        let mut writer = WriteOptions::new()
            .compression(None)
            .library(concat!("clench ", env!("CARGO_PKG_VERSION")))
            .disable_seeking(true)
            .create(NoSeek::new(to))?;
        let mut ids = Vec::new();
        for channel in channels(model) {
            let schema = serde_json::to_vec(&channel.schema).unwrap_or_default();
            let schema = writer.add_schema(channel.schema_name, "jsonschema", &schema)?;
            let id = writer.add_channel(schema, channel.topic, "json", &BTreeMap::new())?;
            ids.push((channel, id));
        }
        Ok(McapRecorder {
            writer,
            channels: ids,
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
        for (channel, id) in &self.channels {
            if channel.once && self.moments > 0 {
                continue;
            }
            let message = channel.message.message(&moment, &time(nanoseconds));
            let header = MessageHeader {
                channel_id: *id,
                sequence: self.moments as u32,
                log_time: nanoseconds,
                publish_time: nanoseconds,
            };
            let bytes = serde_json::to_vec(&message).unwrap_or_default();
            self.writer.write_to_known_channel(&header, &bytes)?;
        }
        self.moments += 1;
        if self.flushed.elapsed() >= FLUSH {
            self.writer.flush()?;
            self.flushed = Instant::now();
        }
        Ok(())
    }

    /// Writes what is not in the file yet and the index of all.
    ///
    /// # Errors
    /// A file that takes no more.
    pub fn finish(mut self) -> Result<(), McapRecordError> {
        self.writer.finish()?;
        Ok(())
    }
}

/// A time as Foxglove's messages have it.
fn time(nanoseconds: u64) -> Value {
    json!({"sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000})
}
