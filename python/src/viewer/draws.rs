//! Objects that a program draws into the picture.

use super::{Viewer, vector};
use crate::arrays::shaped;
use clench_view::{Mark, MarkShape};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The default colour.
const PINK: [f32; 4] = [0.84, 0.2, 0.55, 1.0];

impl Viewer {
    fn draw(
        &self,
        shape: MarkShape,
        rgba: Option<&Bound<'_, PyAny>>,
        lifetime: f64,
    ) -> PyResult<()> {
        let rgba = rgba.map_or(Ok(PINK), |rgba| {
            let values = shaped::<f64>("rgba", rgba, &[4])?;
            let values = values.as_array();
            PyResult::Ok([0, 1, 2, 3].map(|k| values[k] as f32))
        });
        let mark = Mark {
            shape,
            rgba: rgba?,
            lifetime,
        };
        self.open(|viewer| viewer.marks.add(mark))?
            .map_err(PyValueError::new_err)
    }
}

#[pymethods]
impl Viewer {
    /// Draws a sphere.
    ///
    /// Parameters
    /// ----------
    /// center : array_like
    ///     Its centre in the world (3,), m.
    /// radius : float
    ///     m.
    /// rgba : array_like, optional
    ///     Colour and opacity (4,), each from 0 to 1.
    /// lifetime : float
    ///     Duration of display, s of simulated time; 0 for until the next `sync` has shown it.
    #[pyo3(signature = (center, radius = 0.02, *, rgba = None, lifetime = 0.0))]
    fn draw_sphere(
        &self,
        center: &Bound<'_, PyAny>,
        radius: f64,
        rgba: Option<&Bound<'_, PyAny>>,
        lifetime: f64,
    ) -> PyResult<()> {
        let center = vector("center", center)?;
        self.draw(MarkShape::Sphere { center, radius }, rgba, lifetime)
    }

    /// Draws a straight line.
    ///
    /// Parameters
    /// ----------
    /// start, end : array_like
    ///     Its ends in the world (3,), m.
    /// radius : float
    ///     Half its thickness, m.
    /// rgba : array_like, optional
    ///     Colour and opacity (4,), each from 0 to 1.
    /// lifetime : float
    ///     As for `draw_sphere`.
    #[pyo3(signature = (start, end, radius = 0.004, *, rgba = None, lifetime = 0.0))]
    fn draw_line(
        &self,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        radius: f64,
        rgba: Option<&Bound<'_, PyAny>>,
        lifetime: f64,
    ) -> PyResult<()> {
        let (from, to) = (vector("start", start)?, vector("end", end)?);
        self.draw(MarkShape::Line { from, to, radius }, rgba, lifetime)
    }

    /// Draws an arrow.
    ///
    /// Parameters
    /// ----------
    /// start, end : array_like
    ///     The tail and the tip in the world (3,), m.
    /// radius : float
    ///     Half the thickness of its shaft, m.
    /// rgba : array_like, optional
    ///     Colour and opacity (4,), each from 0 to 1.
    /// lifetime : float
    ///     As for `draw_sphere`.
    #[pyo3(signature = (start, end, radius = 0.008, *, rgba = None, lifetime = 0.0))]
    fn draw_arrow(
        &self,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        radius: f64,
        rgba: Option<&Bound<'_, PyAny>>,
        lifetime: f64,
    ) -> PyResult<()> {
        let (from, to) = (vector("start", start)?, vector("end", end)?);
        self.draw(MarkShape::Arrow { from, to, radius }, rgba, lifetime)
    }

    /// Draws text that faces the camera.
    ///
    /// Parameters
    /// ----------
    /// at : array_like
    ///     The centre of the text in the world (3,), m.
    /// text : str
    ///     At most 200 characters.
    /// rgba : array_like, optional
    ///     Colour and opacity (4,), each from 0 to 1.
    /// lifetime : float
    ///     As for `draw_sphere`.
    #[pyo3(signature = (at, text, *, rgba = None, lifetime = 0.0))]
    fn draw_text(
        &self,
        at: &Bound<'_, PyAny>,
        text: String,
        rgba: Option<&Bound<'_, PyAny>>,
        lifetime: f64,
    ) -> PyResult<()> {
        let at = vector("at", at)?;
        self.draw(MarkShape::Text { at, text }, rgba, lifetime)
    }

    /// Removes everything that was drawn.
    fn clear_draws(&self) -> PyResult<()> {
        self.open(|viewer| viewer.marks.clear())
    }
}
