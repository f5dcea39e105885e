//! The names of elements in a file, and the error of saving.

use clench_dynamics::Model;
use clench_dynamics::model::Body;

/// An error about content that MJCF cannot express.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{element} cannot be written as MJCF: {reason}")]
pub struct SaveError {
    /// The element, such as `joint "knee"`.
    pub element: String,
    /// The reason that it cannot be written.
    pub reason: String,
}

impl SaveError {
    pub(in crate::mjcf) fn new(element: impl Into<String>, reason: impl Into<String>) -> Self {
        SaveError {
            element: element.into(),
            reason: reason.into(),
        }
    }
}

/// Returns the label of an element in errors.
pub(in crate::mjcf) fn label(kind: &str, name: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => format!("{kind} \"{name}\""),
    }
}

/// Returns the name by which another element refers to one.
pub(in crate::mjcf) fn named<'a>(
    kind: &str,
    name: &'a str,
    index: usize,
) -> Result<&'a str, SaveError> {
    match name {
        "" => Err(SaveError::new(
            label(kind, name, index),
            "another element refers to it, but it has no name",
        )),
        name => Ok(name),
    }
}

/// Returns the name of a body; the world's is fixed.
pub(in crate::mjcf) fn body_name(model: &Model, index: usize) -> Result<&str, SaveError> {
    let Body { name, .. } = &model.bodies[index];
    match index {
        0 => Ok("world"),
        _ => named("body", name, index),
    }
}
