//! What to say where a name is that nothing has.

use pyo3::PyErr;
use pyo3::exceptions::{PyAttributeError, PyValueError};

/// Most names that a message lists.
const LISTED: usize = 10;

/// Nothing of this kind is called `name`; `known` are those that are.
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

/// An object of this class has no attribute `name`; `known` are some that it has.
pub(crate) fn no_attribute(class: &str, name: &str, known: &[&str]) -> PyErr {
    let hint = nearest(name, known).map(did_you_mean).unwrap_or_default();
    PyAttributeError::new_err(format!("{class} has no attribute \"{name}\"{hint}"))
}

fn did_you_mean(known: &str) -> String {
    format!("; did you mean \"{known}\"?")
}

/// The name that was probably meant: one that goes on where `name` ends or begins before it, such as `body_mass` for `mass`,
/// or else the one with the fewest letters to change.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let distance = |known: &str| strsim::damerau_levenshtein(known, name);
    let holds = |known: &&&str| {
        known
            .strip_suffix(name)
            .is_some_and(|start| start.ends_with('_'))
    };
    let held = known.iter().find(holds);
    let close = || {
        (known.iter())
            .filter(|known| distance(known) <= known.len().max(name.len()) / 3)
            .min_by_key(|known| distance(known))
    };
    held.or_else(close).copied()
}
