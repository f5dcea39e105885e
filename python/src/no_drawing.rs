//! Replacement of `drawing` in a package that is built without rendering.

use crate::envs::{Envs, Scenes};
use crate::error::classes::ClenchError;
use crate::viewed::Target;
use pyo3::prelude::*;

/// The pictures that a user requests.
#[expect(dead_code, reason = "nothing draws")]
pub(crate) struct Wanted<'a, 'py> {
    pub(crate) size: (u32, u32),
    pub(crate) camera: Option<&'a Bound<'py, PyAny>>,
    pub(crate) kind: &'a str,
    pub(crate) device: Option<&'a str>,
    pub(crate) threads: usize,
    pub(crate) groups: Option<Vec<usize>>,
    pub(crate) out: Option<&'a Bound<'py, PyAny>>,
}

/// Returns an error that says how to build a package that draws.
pub(crate) fn draw<'py>(
    _: Python<'py>,
    _: &Scenes,
    _: (&Target, &Envs),
    _: Wanted<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let text = crate::device::without("pictures", "render");
    Err(ClenchError::new_err(text))
}

/// Returns an error that says how to build a package that draws.
#[pyfunction]
pub(crate) fn render_device() -> PyResult<Option<String>> {
    let text = crate::device::without("pictures", "render");
    Err(ClenchError::new_err(text))
}
