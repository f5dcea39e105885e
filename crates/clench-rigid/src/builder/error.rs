//! What can be wrong with a model, and where.

use std::fmt;
use std::sync::Arc;

/// Where an element was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// File name as the user gave it, or as an include names it.
    pub file: Arc<str>,
    /// Line, counted from one.
    pub line: u32,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

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

impl BuildError {
    /// An error of something that is not an element with an origin of its own.
    pub(super) fn new(element: impl Into<String>, message: impl Into<String>) -> Self {
        BuildError {
            origin: None,
            element: element.into(),
            message: message.into(),
        }
    }

    /// The same error of an element called otherwise.
    pub(super) fn about(mut self, element: &str) -> Self {
        element.clone_into(&mut self.element);
        self
    }

    /// The same error, saying also on which body the element is.
    pub(super) fn of_body(mut self, body: &str) -> Self {
        self.element = format!("{} of {body}", self.element);
        self
    }
}
