//! Recorded frames and the page that replays them from a file.

use crate::frame::{FrameExtras, MAGIC, SECTIONS, encode};
use crate::marks::Marks;
use crate::{Page, Scene};
use clench::SimError;
use clench::formats::base64;
use clench::rigid::{Precision, Sim};
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// The frames of a simulation.
pub struct Recording {
    /// The scene as the page reads it.
    scene: Value,
    /// The frames in base 64, encoded separately.
    frames: Vec<String>,
    bytes: usize,
    limit: usize,
}

/// An error of recording a frame.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The state of the simulation cannot be evaluated.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The recording would exceed the limit.
    #[error("a recording of {0} frames reaches the limit of {1} MB: record fewer frames")]
    Full(usize, f64),
}

/// An error of reading a recording from a page.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The page contains no recording, or a truncated one.
    #[error("this is not a page of Clench with a complete recording")]
    None,
    /// The format of the frames is of another version.
    #[error("this recording was made by another version of Clench; it can be opened in a browser")]
    Version,
    /// The recording exceeds the limit.
    #[error("this recording exceeds the limit of {0} MB")]
    Full(f64),
}

impl Recording {
    /// Creates an empty recording of at most `limit` bytes.
    pub fn new(scene: Scene, limit: usize) -> Self {
        Recording {
            scene: json!(scene.passive()),
            frames: Vec::new(),
            bytes: 0,
            limit,
        }
    }

    /// Returns the number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }
    /// Returns true if there is no frame.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Returns true if frames of the scene can be appended.
    pub fn is_of(&self, scene: Scene) -> bool {
        self.scene == json!(scene.passive())
    }

    /// Records the present state with the marks.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated or the recording is full.
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
            return Err(RecordError::Full(self.frames.len(), megabytes(self.limit)));
        }
        self.bytes += frame.len();
        self.frames.push(frame);
        Ok(())
    }

    /// Returns the times of the frames, s.
    pub fn times(&self) -> Vec<f64> {
        self.frames.iter().filter_map(|frame| time(frame)).collect()
    }

    /// Writes an HTML document that replays the recording without a server. The frames are not copied.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub fn write_html(&self, page: &Page, out: &mut impl Write) -> io::Result<()> {
        let (before, after) = page.around_data();
        // In HTML, `</script` ends a script, and `<!--` followed by `<script` keeps the next `</script` from ending it.
        // In JSON, only strings contain `<`, where `\u003c` is equivalent. Base 64 does not contain it.
        let scene = self.scene.to_string().replace('<', "\\u003c");
        write!(out, "{before}{{\"scene\":{scene},\"frames\":[")?;
        for (k, frame) in self.frames.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(out, "{comma}\"{frame}\"")?;
        }
        write!(out, "]}}{after}")?;
        out.flush()
    }

    /// Reads the recording of such a document, of at most `limit` bytes.
    ///
    /// # Errors
    /// Returns an error if the document contains no recording, one of another version, or one above the limit.
    pub fn from_html(html: &str, limit: usize) -> Result<Self, ReadError> {
        let data = Page::data(html).ok_or(ReadError::None)?;
        let mut data: Map<String, Value> =
            serde_json::from_str(data).map_err(|_| ReadError::None)?;
        let (Some(Value::Array(frames)), Some(scene)) =
            (data.remove("frames"), data.remove("scene"))
        else {
            return Err(ReadError::None);
        };
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
            return Err(ReadError::Full(megabytes(limit)));
        }
        Ok(Recording {
            scene,
            frames,
            bytes,
            limit,
        })
    }
}

/// Converts bytes to megabytes.
fn megabytes(bytes: usize) -> f64 {
    bytes as f64 / 1e6
}

/// Returns the time of a frame; `None` if it is invalid.
fn time(frame: &str) -> Option<f64> {
    // 24 characters of base 64 are more than the first sixteen bytes.
    let head = base64::decode(frame.get(..24)?).ok()?;
    let time = head.get(8..16)?.try_into().ok()?;
    head.starts_with(&MAGIC).then_some(f64::from_le_bytes(time))
}
