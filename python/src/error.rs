//! Conversion of errors to exceptions. The exception classes are defined in Python, in `clench/errors.py`.

use clench::solver::ProblemError;
use clench::{LoadError, SimError};
use pyo3::PyErr;
use pyo3::exceptions::{PyIndexError, PyMemoryError, PyValueError};

/// The classes of `clench.errors`.
pub(crate) mod classes {
    pyo3::import_exception!(clench.errors, ClenchError);
    pyo3::import_exception!(clench.errors, LoadError);
    pyo3::import_exception!(clench.errors, SimulationError);
    pyo3::import_exception!(clench.errors, BusyError);
}

/// Converts an error of loading a file.
pub(crate) fn load_error(error: LoadError) -> PyErr {
    let LoadError {
        file,
        line,
        element,
        message,
        incomplete: _,
    } = error;
    classes::LoadError::new_err((message, file.to_string(), line, element))
}

/// Converts an error of a simulation or of its arguments.
pub(crate) fn sim_error(error: SimError) -> PyErr {
    let text = error.to_string();
    match error {
        SimError::Fault(_) => classes::SimulationError::new_err(text),
        SimError::NoSuchElement { .. } => PyIndexError::new_err(text),
        SimError::OutOfMemory { .. } => PyMemoryError::new_err(text),
        SimError::Instructions(_)
        | SimError::Threads(_)
        | SimError::Forked
        | SimError::Backend(_) => classes::ClenchError::new_err(text),
        SimError::Option(_)
        | SimError::UnsupportedPair(_)
        | SimError::NotDiscrete(_)
        | SimError::WrongLength { .. }
        | SimError::OutOfRange { .. }
        | SimError::Parameter { .. }
        | SimError::Follows { .. }
        | SimError::SingularMass { .. }
        | SimError::Unknown { .. }
        | SimError::NoFreeSlot { .. }
        | SimError::StaleConstraint
        | SimError::CannotHold { .. }
        | SimError::NoHeightField { .. }
        | SimError::FixedOption(_)
        | SimError::NoModel
        | SimError::OneModel(_)
        | SimError::ModelsDiffer { .. }
        | SimError::NoDiscreteInverse
        | SimError::Contact { .. } => PyValueError::new_err(text),
    }
}

/// Converts an error of a bare problem.
pub(crate) fn problem_error(error: ProblemError) -> PyErr {
    PyValueError::new_err(match error {
        ProblemError::MassNotPositiveDefinite { .. } => "M is not positive definite".to_owned(),
        ProblemError::Block { block, reason } => format!("blocks[{block}]: {reason}"),
        other => other.to_string(),
    })
}

/// Returns the error that another thread is using `what`.
pub(crate) fn busy(what: &str) -> PyErr {
    classes::BusyError::new_err(format!("another thread is using this {what}"))
}
