//! Frames that are kept, and the page that replays them from a file.

use crate::frame::{Timing, encode};
use crate::{Page, Scene};
use clench::SimError;
use clench::rigid::{Precision, Sim};
use data_encoding::BASE64;
use serde_json::json;

/// What happened in a simulation, moment by moment.
pub struct Recording {
    scene: Scene,
    /// Frames as base 64, each on its own.
    frames: Vec<String>,
    bytes: usize,
    limit: usize,
}

/// Why a frame could not be kept.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The simulation has no frame to give.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// It would be larger than allowed.
    #[error("a recording of {0} frames takes all of the {1} MB that it may: record fewer of them")]
    Full(usize, usize),
}

impl Recording {
    /// An empty recording of so many bytes at most.
    pub fn new(scene: Scene, limit: usize) -> Self {
        Recording {
            scene: scene.passive(),
            frames: Vec::new(),
            bytes: 0,
            limit,
        }
    }

    /// How many frames there are.
    pub fn len(&self) -> usize {
        self.frames.len()
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Keeps what is now.
    ///
    /// # Errors
    /// A state that cannot be evaluated; a recording that is full.
    pub fn append<T: Precision>(&mut self, sim: &mut Sim<T>) -> Result<(), RecordError> {
        let frame = BASE64.encode(&encode(sim, 0, Timing::default(), None)?);
        if self.bytes + frame.len() > self.limit {
            return Err(RecordError::Full(self.frames.len(), self.limit / 1_000_000));
        }
        self.bytes += frame.len();
        self.frames.push(frame);
        Ok(())
    }

    /// One HTML document that replays it without a server.
    pub fn to_html(&self, page: &Page) -> String {
        let data = json!({"scene": self.scene, "frames": self.frames});
        page.with_data(&data.to_string())
    }
}
