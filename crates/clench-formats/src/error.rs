//! Errors of model files, with their location.

use clench_builder::{BuildError, Origin, shorten};
use std::sync::Arc;

/// A model file error: the file, the line, the element and a message.
///
/// Displayed as `robot.xml:12: joint "knee": ...`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.describe())]
pub struct LoadError {
    /// The file as named by the user or an include; empty if the model came from no file.
    pub file: Arc<str>,
    /// The line, counted from one; `None` if the error concerns the whole file.
    pub line: Option<u32>,
    /// The element, such as `joint "knee"`; `None` if the error concerns the whole file.
    pub element: Option<String>,
    /// The error message.
    pub message: String,
    /// True if the element only lacks something; its attributes may all be valid.
    pub incomplete: bool,
}

impl LoadError {
    /// Creates an error about a file as a whole.
    pub(crate) fn file(file: &Arc<str>, message: impl Into<String>) -> Self {
        LoadError {
            file: file.clone(),
            line: None,
            element: None,
            message: shorten(&message.into()),
            incomplete: false,
        }
    }

    /// Creates an error at a line, before elements are parsed.
    pub(crate) fn line(file: &Arc<str>, line: u32, message: impl Into<String>) -> Self {
        LoadError {
            line: Some(line),
            ..LoadError::file(file, message)
        }
    }

    /// Creates an error about an element.
    pub(crate) fn element(origin: &Origin, element: String, message: impl Into<String>) -> Self {
        LoadError {
            element: Some(shorten(&element)),
            ..LoadError::line(&origin.file, origin.line, message)
        }
    }

    fn describe(&self) -> String {
        let mut text = String::new();
        if !self.file.is_empty() {
            text += &self.file;
            text.push(':');
        }
        if let Some(line) = self.line {
            let prefix = if text.is_empty() { "line " } else { "" };
            text += &format!("{prefix}{line}:");
        }
        if !text.is_empty() {
            text.push(' ');
        }
        if let Some(element) = &self.element {
            text += element;
            text += ": ";
        }
        text + &self.message
    }
}

impl From<BuildError> for LoadError {
    fn from(error: BuildError) -> Self {
        let (file, line) = match error.origin {
            Some(origin) => (origin.file, Some(origin.line)),
            None => (Arc::from(""), None),
        };
        LoadError {
            file,
            line,
            element: Some(error.element),
            message: error.message,
            incomplete: false,
        }
    }
}
