//! The errors of building a model.

use super::Origin;
use std::fmt;

/// The error of a model that cannot be built: the element, its source location, and a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuildError {
    /// The source location of the element, if it came from a file.
    pub origin: Option<Origin>,
    /// The element, such as `joint "knee"`.
    pub element: String,
    /// The message.
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

/// Longer texts are truncated in messages, bytes.
const MAX_LENGTH: usize = 600;
/// The length of both ends of a truncated text, bytes.
const ENDS: usize = 250;

/// Shortens a long text for a message to its beginning and end.
pub fn shorten(text: &str) -> String {
    if text.len() <= MAX_LENGTH {
        return text.to_owned();
    }
    let boundary = |from: usize| (from..text.len()).find(|&at| text.is_char_boundary(at));
    let head = boundary(ENDS).unwrap_or(0);
    let tail = boundary(text.len() - ENDS).unwrap_or(text.len());
    let omitted = tail - head;
    format!(
        "{} [... {omitted} bytes ...] {}",
        &text[..head],
        &text[tail..]
    )
}

impl BuildError {
    /// Creates an error of an object that is not an element with an origin of its own.
    pub(super) fn new(element: impl Into<String>, message: impl Into<String>) -> Self {
        BuildError {
            origin: None,
            element: shorten(&element.into()),
            message: shorten(&message.into()),
        }
    }

    /// Returns the same error with another element name.
    pub(super) fn about(mut self, element: &str) -> Self {
        element.clone_into(&mut self.element);
        self
    }

    /// Returns the same error with the body of the element.
    pub(super) fn of_body(mut self, body: &str) -> Self {
        self.element = shorten(&format!("{} of {body}", self.element));
        self
    }
}
