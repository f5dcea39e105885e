//! The precision of numbers, as users name it.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// `"64"` or `"32"`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Bits {
    B64,
    B32,
}

impl Bits {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Bits::B64 => "64",
            Bits::B32 => "32",
        }
    }
}

impl FromPyObject<'_, '_> for Bits {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let Ok(text) = object.cast::<PyString>() else {
            let found = object.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "precision must be \"64\" or \"32\", a str, not {found}"
            )));
        };
        match text.to_str()? {
            "64" => Ok(Bits::B64),
            "32" => Ok(Bits::B32),
            other => Err(PyValueError::new_err(format!(
                "precision is \"{other}\", but must be \"64\" or \"32\""
            ))),
        }
    }
}
