//! Frames that are kept, and the page that replays them from a file.

use crate::frame::{FrameExtras, MAGIC, SECTIONS, encode};
use crate::marks::Marks;
use crate::{Page, Scene};
use clench::SimError;
use clench::formats::base64;
use clench::rigid::{Precision, Sim};
use serde_json::{Value, json};

/// What happened in a simulation, moment by moment.
pub struct Recording {
    /// As the page reads it.
    scene: Value,
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

/// Why a page cannot be read as a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// There is none in it, or it was cut off.
    #[error("this is no page of Clench with a whole recording in it")]
    None,
    /// The frames mean something else.
    #[error("this recording was made by another version of Clench; it can be opened in a browser")]
    Version,
    /// It is larger than allowed.
    #[error("this recording is larger than the {0} MB that it may be")]
    Full(usize),
}

impl Recording {
    /// An empty recording of so many bytes at most.
    pub fn new(scene: Scene, limit: usize) -> Self {
        Recording {
            scene: json!(scene.passive()),
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

    /// Whether the frames of a scene can be appended to those that are here.
    pub fn is_of(&self, scene: Scene) -> bool {
        self.scene == json!(scene.passive())
    }

    /// Keeps what is now, with what users draw.
    ///
    /// # Errors
    /// A state that cannot be evaluated; a recording that is full.
    pub fn append<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        marks: &mut Marks,
    ) -> Result<(), RecordError> {
        let extras = FrameExtras {
            marks: marks.at(sim.state.time).collect(),
            ..FrameExtras::default()
        };
        let frame = encode(sim, &extras)?;
        marks.shown();
        let frame = base64::encode(&frame);
        if self.bytes + frame.len() > self.limit {
            return Err(RecordError::Full(self.frames.len(), self.limit / 1_000_000));
        }
        self.bytes += frame.len();
        self.frames.push(frame);
        Ok(())
    }

    /// The times of the frames, s.
    pub fn times(&self) -> Vec<f64> {
        self.frames.iter().filter_map(|frame| time(frame)).collect()
    }

    /// One HTML document that replays it without a server.
    pub fn to_html(&self, page: &Page) -> String {
        let data = json!({"scene": self.scene, "frames": self.frames});
        page.with_data(&data.to_string())
    }

    /// The recording in such a document, of so many bytes at most.
    ///
    /// # Errors
    /// A document without one, or with one that this version could not have written.
    pub fn from_html(html: &str, limit: usize) -> Result<Self, ReadError> {
        let data = Page::data(html).ok_or(ReadError::None)?;
        let mut data: Value = serde_json::from_str(data).map_err(|_| ReadError::None)?;
        let Value::Array(frames) = data["frames"].take() else {
            return Err(ReadError::None);
        };
        let scene = data["scene"].take();
        let sections = SECTIONS
            .iter()
            .map(|s| json!({"name": s.name, "width": s.width}));
        if scene["sections"] != Value::Array(sections.collect()) {
            return Err(ReadError::Version);
        }
        let text = |frame| match frame {
            Value::String(text) if time(&text).is_some() => Ok(text),
            _ => Err(ReadError::None),
        };
        let frames: Vec<_> = frames.into_iter().map(text).collect::<Result<_, _>>()?;
        let bytes = frames.iter().map(String::len).sum();
        if bytes > limit {
            return Err(ReadError::Full(limit / 1_000_000));
        }
        Ok(Recording {
            scene,
            frames,
            bytes,
            limit,
        })
    }
}

/// The time of a frame, if it is one.
fn time(frame: &str) -> Option<f64> {
    // Sixteen bytes are the first of these letters.
    let head = base64::decode(frame.get(..24)?).ok()?;
    let time = head.get(8..16)?.try_into().ok()?;
    head.starts_with(&MAGIC).then_some(f64::from_le_bytes(time))
}
