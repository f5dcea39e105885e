//! Replacement of `drawing` in a package that is built without rendering.

use crate::envs::{Envs, Scene};
use crate::error::classes::ClenchError;
use crate::model::Model;
use crate::viewed::Target;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The pictures that a user requests.
#[expect(dead_code, reason = "nothing draws")]
pub(crate) struct DrawRequest<'a, 'py> {
    pub(crate) layout: &'a clench::Model,
    pub(crate) n: Option<usize>,
    pub(crate) size: (u32, u32),
    pub(crate) camera: Option<&'a Bound<'py, PyAny>>,
    pub(crate) kind: &'a str,
    pub(crate) device: Option<&'a str>,
    pub(crate) threads: usize,
    pub(crate) groups: Option<Vec<usize>>,
    pub(crate) out: Option<&'a Bound<'py, PyAny>>,
    pub(crate) appearance: Option<&'a Bound<'py, PyAny>>,
}

fn without() -> PyErr {
    ClenchError::new_err(crate::device::without("pictures", "render"))
}

/// Returns an error that says how to build a package that draws.
pub(crate) fn draw<'py>(
    _: Python<'py>,
    _: &[Scene],
    _: (&Target, &Envs),
    _: DrawRequest<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    Err(without())
}

/// Returns the same error.
pub(crate) fn appearance<'py>(_: Python<'py>, _: &Model) -> PyResult<Bound<'py, PyDict>> {
    Err(without())
}

/// Names the graphics device that draws pictures.
///
/// Returns
/// -------
/// str or None
///     Its name; None if there is none, so that ``render`` casts rays on the processor, which find distances and geoms
///     but no colours.
///
/// Raises
/// ------
/// ClenchError
///     If the package was built without rendering; the message says how to build it with that.
#[pyfunction]
pub(crate) fn render_device() -> PyResult<Option<String>> {
    Err(without())
}
