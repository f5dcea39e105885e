//! Conversion of option values from and to Python, and their validation.

use clench::rigid::options::{ContactModel, FrictionCone, MaxContacts, OptionValue, RigidOption};
use clench::solver::{ConstraintSolver, Switch};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

/// The maximum number of iterations, sweeps or contacts.
const MAX_COUNT: usize = i32::MAX as usize;

/// A type of option that can be read from Python.
pub(crate) trait OptionType: Sized {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self>;
}

/// Returns the value of an option, or an error about the `given` object if it is out of range.
pub(crate) fn in_range<T: Copy + Into<OptionValue>>(
    option: RigidOption,
    value: T,
    given: &Bound<'_, PyAny>,
) -> PyResult<T> {
    match option.range().holds(value.into()) {
        true => Ok(value),
        false => Err(out_of_range(option.name(), given, option.range().text())),
    }
}

impl OptionType for f64 {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if value.is_instance_of::<PyBool>() {
            return Err(wrong_type(name, value, "a number"));
        }
        value
            .extract()
            .map_err(|error| explain(error, name, value, "a number", "finite"))
    }
}

impl OptionType for usize {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let range = format!("from 0 to {MAX_COUNT}");
        if value.is_instance_of::<PyBool>() {
            return Err(wrong_type(name, value, "an integer"));
        }
        match value.extract::<i64>() {
            Ok(n) => usize::try_from(n)
                .ok()
                .filter(|&n| n <= MAX_COUNT)
                .ok_or_else(|| out_of_range(name, value, &range)),
            Err(error) => Err(explain(error, name, value, "an integer", &range)),
        }
    }
}

impl OptionType for bool {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        value
            .extract()
            .map_err(|_| wrong_type(name, value, "a bool"))
    }
}

impl OptionType for Switch {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(text) = value.cast::<PyString>() {
            return match text == "auto" {
                true => Ok(Switch::Auto),
                false => Err(out_of_range(name, value, "a bool or \"auto\"")),
            };
        }
        match value.extract() {
            Ok(true) => Ok(Switch::On),
            Ok(false) => Ok(Switch::Off),
            Err(_) => Err(wrong_type(name, value, "a bool or \"auto\"")),
        }
    }
}

impl OptionType for MaxContacts {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(text) = value.cast::<PyString>() {
            return match text == "auto" {
                true => Ok(MaxContacts::Auto),
                false => Err(out_of_range(name, value, "an integer or \"auto\"")),
            };
        }
        usize::read(name, value).map(MaxContacts::Limit)
    }
}

impl OptionType for ConstraintSolver {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        choose(name, value, &ALGORITHMS)
    }
}

impl OptionType for FrictionCone {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        choose(name, value, &CONES)
    }
}

impl OptionType for ContactModel {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        choose(name, value, &CONTACT_MODELS)
    }
}

const ALGORITHMS: [(&str, ConstraintSolver); 2] = [
    ("Newton", ConstraintSolver::Newton),
    ("CG", ConstraintSolver::Cg),
];
const CONES: [(&str, FrictionCone); 2] = [
    ("pyramidal", FrictionCone::Pyramidal),
    ("elliptic", FrictionCone::Elliptic),
];
const CONTACT_MODELS: [(&str, ContactModel); 2] = [
    ("convex", ContactModel::Convex),
    ("coulomb", ContactModel::Coulomb),
];

fn choose<T: Copy>(name: &str, value: &Bound<'_, PyAny>, choices: &[(&str, T)]) -> PyResult<T> {
    let Ok(text) = value.cast::<PyString>() else {
        return Err(wrong_type(name, value, "a str"));
    };
    match choices.iter().find(|(choice, _)| text == choice) {
        Some(&(_, chosen)) => Ok(chosen),
        None => {
            let names = choices.iter().map(|(choice, _)| format!("\"{choice}\""));
            Err(out_of_range(
                name,
                value,
                &Vec::from_iter(names).join(" or "),
            ))
        }
    }
}

fn explain(error: PyErr, name: &str, value: &Bound<'_, PyAny>, what: &str, range: &str) -> PyErr {
    let py = value.py();
    if error.is_instance_of::<PyOverflowError>(py) {
        out_of_range(name, value, range)
    } else if error.is_instance_of::<PyTypeError>(py) {
        wrong_type(name, value, what)
    } else {
        error
    }
}

fn out_of_range(name: &str, value: &Bound<'_, PyAny>, range: &str) -> PyErr {
    match value.repr() {
        Ok(shown) => {
            PyValueError::new_err(format!("option {name} is {shown}, but must be {range}"))
        }
        Err(error) => error,
    }
}

fn wrong_type(name: &str, value: &Bound<'_, PyAny>, what: &str) -> PyErr {
    match value.get_type().name() {
        Ok(found) => PyTypeError::new_err(format!("option {name} must be {what}, not {found}")),
        Err(error) => error,
    }
}

/// A type of option that can be converted to Python.
pub(crate) trait Show {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>>;
}

impl Show for f64 {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(self.into_pyobject(py)?.into_any())
    }
}
impl Show for usize {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(self.into_pyobject(py)?.into_any())
    }
}
impl Show for bool {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(PyBool::new(py, self).to_owned().into_any())
    }
}
impl Show for &str {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(PyString::new(py, self).into_any())
    }
}
impl Show for Switch {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            Switch::Auto => "auto".show(py),
            Switch::On => true.show(py),
            Switch::Off => false.show(py),
        }
    }
}
impl Show for MaxContacts {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            MaxContacts::Auto => "auto".show(py),
            MaxContacts::Limit(max) => max.show(py),
        }
    }
}
impl Show for ConstraintSolver {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            ConstraintSolver::Newton => "Newton".show(py),
            ConstraintSolver::Cg => "CG".show(py),
        }
    }
}
impl Show for FrictionCone {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            FrictionCone::Pyramidal => "pyramidal".show(py),
            FrictionCone::Elliptic => "elliptic".show(py),
        }
    }
}
impl Show for ContactModel {
    fn show(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            ContactModel::Convex => "convex".show(py),
            ContactModel::Coulomb => "coulomb".show(py),
        }
    }
}
