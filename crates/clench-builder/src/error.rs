//! What can be wrong with a model, and where.

use super::Origin;
use std::fmt;

/// A model that cannot be built: the element, where it stands, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuildError {
    /// Where the element was written, if it came from a file.
    pub origin: Option<Origin>,
    /// The element, such as `joint "knee"`.
    pub element: String,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(origin) = &self.origin {
            write!(f, "{origin}: ")?;
        }
        write!(f, "{}: {}", self.element, self.message)
    }
}

impl std::error::Error for BuildError {}

/// Texts longer than this are cut in messages, bytes.
const MAX_LENGTH: usize = 600;
/// What is left of both ends of a text that is cut.
const ENDS: usize = 250;

/// A text for a message: as it is, or its beginning and end where it is long.
pub fn shorten(text: &str) -> String {
    if text.len() <= MAX_LENGTH {
        return text.to_owned();
    }
    let boundary = |from: usize| (from..text.len()).find(|&at| text.is_char_boundary(at));
    let head = boundary(ENDS).unwrap_or(0);
    let tail = boundary(text.len() - ENDS).unwrap_or(text.len());
    let left_out = tail - head;
    format!(
        "{} [... {left_out} bytes ...] {}",
        &text[..head],
        &text[tail..]
    )
}

impl BuildError {
    /// An error of something that is not an element with an origin of its own.
    pub(super) fn new(element: impl Into<String>, message: impl Into<String>) -> Self {
        BuildError {
            origin: None,
            element: shorten(&element.into()),
            message: shorten(&message.into()),
        }
    }

    /// The same error of an element called otherwise.
    pub(super) fn about(mut self, element: &str) -> Self {
        element.clone_into(&mut self.element);
        self
    }

    /// The same error, saying also on which body the element is.
    pub(super) fn of_body(mut self, body: &str) -> Self {
        self.element = shorten(&format!("{} of {body}", self.element));
        self
    }
}
