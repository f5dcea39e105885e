//! Names from Python, and error messages for unknown ones.

use pyo3::exceptions::{PyAttributeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// The maximum number of names that a message lists.
const LISTED: usize = 10;

/// Several names.
pub(crate) struct Names(pub(crate) Vec<String>);

impl FromPyObject<'_, '_> for Names {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        // A str is also a sequence in Python: of letters.
        if let Ok(name) = object.cast::<PyString>() {
            let name = name.to_string_lossy();
            return Err(PyTypeError::new_err(format!(
                "expected a sequence of names, such as [\"{name}\"], not a str"
            )));
        }
        object.extract().map(Names)
    }
}

/// Returns the error that nothing of this kind is called `name`; `known` are the existing names.
pub(crate) fn unknown(kind: &str, name: &str, known: &[&str]) -> PyErr {
    let known: Vec<&str> = (known.iter().copied())
        .filter(|known| !known.is_empty())
        .collect();
    let mut text = format!("there is no {kind} \"{name}\"");
    match nearest(name, &known) {
        Some(known) => text += &did_you_mean(known),
        None if known.is_empty() => {}
        None => {
            text += ": there are ";
            text += &known[..known.len().min(LISTED)].join(", ");
            if known.len() > LISTED {
                text += &format!(" and {} more", known.len() - LISTED);
            }
        }
    }
    PyValueError::new_err(text)
}

/// Returns the error that an object of this class has no attribute `name`; `known` are some that it has.
pub(crate) fn no_attribute(class: &str, name: &str, known: &[&str]) -> PyErr {
    let hint = nearest(name, known).map(did_you_mean).unwrap_or_default();
    PyAttributeError::new_err(format!("{class} has no attribute \"{name}\"{hint}"))
}

fn did_you_mean(known: &str) -> String {
    format!("; did you mean \"{known}\"?")
}

/// Returns the name that was probably meant: one that extends `name` at either end, such as `body_mass` for `mass`, or
/// else the one with the smallest edit distance.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let distance = |known: &str| strsim::damerau_levenshtein(known, name);
    let extends = |known: &&&str| {
        known
            .strip_suffix(name)
            .is_some_and(|start| start.ends_with('_'))
    };
    let extension = known.iter().find(extends);
    let close = || {
        (known.iter())
            .filter(|known| distance(known) <= known.len().max(name.len()) / 3)
            .min_by_key(|known| distance(known))
    };
    extension.or_else(close).copied()
}
