//! `clench.RigidOptions`: the options that were set, each checked separately. The table of options defines them.

use crate::option_values::{OptionType, Show, in_range};
use clench::rigid::options::RigidOption;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Returns the documented Python type for an option type.
macro_rules! given {
    (usize) => {
        "int"
    };
    (f64) => {
        "float"
    };
    (bool) => {
        "bool"
    };
    (Switch) => {
        "bool or \"auto\""
    };
    (MaxContacts) => {
        "int or \"auto\""
    };
    (ConstraintSolver) => {
        "{\"Newton\", \"CG\"}"
    };
    (FrictionCone) => {
        "{\"pyramidal\", \"elliptic\"}"
    };
    (ContactModel) => {
        "{\"convex\", \"coulomb\"}"
    };
}

macro_rules! declare_class {
    ($($group:ident {$(
        $(#[doc = $doc:literal])*
        $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
    )*})*) => {
        /// Options of the constraint model and its solver.
        ///
        /// Options that are set here take precedence over the model's file, and the file over the defaults below. An
        /// option that is not set is None.
        ///
        /// Parameters
        /// ----------
        $($(
            #[doc = concat!(stringify!($name), " : ", given!($type), ", optional")]
            $( #[doc = concat!("   ", $doc)] )*
        )*)*
        ///
        /// Raises
        /// ------
        /// ValueError
        ///     If an option is outside its range.
        /// TypeError
        ///     If an option has the wrong type or does not exist.
        ///
        /// Examples
        /// --------
        /// >>> clench.RigidOptions(iterations=20, friction_cone="elliptic")
        /// RigidOptions(iterations=20, friction_cone='elliptic')
        #[pyclass(frozen, eq, module = "clench")]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub(crate) struct RigidOptions(pub(crate) clench::RigidOptions);

        #[pymethods]
        impl RigidOptions {
            #[new]
            #[pyo3(signature = (*, $($($name=None),*),*))]
            #[allow(clippy::too_many_arguments)] // They are keywords.
            fn new($($($name: Option<&Bound<'_, PyAny>>),*),*) -> PyResult<Self> {
                Ok(RigidOptions(clench::RigidOptions {
                    $($($name: $name.map(|given| {
                        let option = RigidOption::$name;
                        let value = OptionType::read(option.name(), given)?;
                        in_range(option, value, given)
                    }).transpose()?,)*)*
                }))
            }

            $($(
            #[doc = concat!(given!($type), " or None :", $($doc),*)]
            #[getter]
            fn $name<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
                self.0.$name.map(|value| value.show(py)).transpose()
            })*)*

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                let set = self.set(py)?;
                let show = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
                    Ok(format!("{name}={}", value.repr()?))
                };
                let shown: Vec<String> = set.iter().map(show).collect::<PyResult<_>>()?;
                Ok(format!("RigidOptions({})", shown.join(", ")))
            }

            fn __getnewargs_ex__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
                Ok((PyTuple::empty(py), self.set(py)?))
            }
        }

        impl RigidOptions {
            /// Returns the options that are set, in order.
            fn set<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
                let set = PyDict::new(py);
                $($(if let Some(value) = self.0.$name {
                    set.set_item(stringify!($name), value.show(py)?)?;
                })*)*
                Ok(set)
            }
        }
    };
}

clench::rigid::rigid_options!(declare_class);
