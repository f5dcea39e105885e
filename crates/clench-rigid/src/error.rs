//! What can go wrong with a simulation.

use crate::contact::UnsupportedPair;
use crate::settings::OptionError;

/// Why a simulation cannot start, take an input, or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// An option outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Shapes that may meet and cannot be collided.
    #[error(transparent)]
    UnsupportedPair(#[from] UnsupportedPair),
    /// An input of the wrong length.
    #[error("{field} has {found} numbers where the model needs {expected}")]
    WrongLength {
        /// Which part of the state.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that the model needs.
        expected: usize,
    },
    /// An input that is infinite or not a number.
    #[error("{field}[{index}] is {value}")]
    NotFinite {
        /// Which part of the state.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// An input out of its range.
    #[error("{field} is {value}, but must be {range}")]
    OutOfRange {
        /// What was set.
        field: &'static str,
        /// To what.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// An element that the model does not have.
    #[error("there is no {kind} {index}: the model has {count}")]
    NoSuchElement {
        /// Kind of element.
        kind: &'static str,
        /// The number asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A given contact that makes no sense.
    #[error("given contact {index}: {reason}")]
    Contact {
        /// Which contact.
        index: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The mass matrix of the configuration is not positive definite.
    #[error(
        "at t = {time} s the mass matrix is not positive definite: some dof moves no mass, or the state has diverged"
    )]
    Singular {
        /// Time of the state that cannot move on, s.
        time: f64,
    },
    /// The motion left the range of numbers.
    #[error(
        "the simulation diverged in the step from t = {time} s: {field}[{index}] became {value}"
    )]
    Diverged {
        /// Time of the last good state, s.
        time: f64,
        /// Which quantity.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// What it became.
        value: f64,
    },
}
