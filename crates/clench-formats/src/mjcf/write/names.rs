//! What elements are called in a file, and what of a model a file cannot say.

use clench_dynamics::Model;
use clench_dynamics::model::Body;

/// What of a model MJCF cannot say.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{element} cannot be written as MJCF: {reason}")]
pub struct SaveError {
    /// The element, such as `joint "knee"`.
    pub element: String,
    /// Why it cannot be written.
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

/// How errors call an element.
pub(in crate::mjcf) fn label(kind: &str, name: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => format!("{kind} \"{name}\""),
    }
}

/// The name by which another element refers to one.
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

/// The name of a body; the world has one whatever else it is called.
pub(in crate::mjcf) fn body_name(model: &Model, index: usize) -> Result<&str, SaveError> {
    let Body { name, .. } = &model.bodies[index];
    match index {
        0 => Ok("world"),
        _ => named("body", name, index),
    }
}
