//! What can be wrong with a model file, and where.

use clench_builder::{BuildError, Origin, shorten};
use std::sync::Arc;

/// A model file that cannot be loaded: the file, the line, the element, and what is wrong with it.
///
/// Displayed as `robot.xml:12: joint "knee": ...`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.describe())]
pub struct LoadError {
    /// The file as the user named it, or as an include found it; empty where the model came from no file.
    pub file: Arc<str>,
    /// Line, counted from one; `None` where the whole file is meant.
    pub line: Option<u32>,
    /// The element, such as `joint "knee"`; `None` where the whole file is meant.
    pub element: Option<String>,
    /// What is wrong.
    pub message: String,
    /// True if the element lacks something that it needs, and all that it says may be right.
    pub incomplete: bool,
}

impl LoadError {
    /// An error about a file as a whole.
    pub(crate) fn file(file: &Arc<str>, message: impl Into<String>) -> Self {
        LoadError {
            file: file.clone(),
            line: None,
            element: None,
            message: shorten(&message.into()),
            incomplete: false,
        }
    }

    /// An error at a line, before there are elements to speak of.
    pub(crate) fn line(file: &Arc<str>, line: u32, message: impl Into<String>) -> Self {
        LoadError {
            line: Some(line),
            ..LoadError::file(file, message)
        }
    }

    /// An error about an element.
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
            text += &format!("{line}:");
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
