//! Free cameras.

use crate::arrays::shaped;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A camera that belongs to no model, like MuJoCo's free camera: it looks at a point from a distance and a direction.
///
/// Parameters
/// ----------
/// lookat : array_like
///     The point in the middle of the picture (3,), m.
/// distance : float
///     Distance from that point, m.
/// azimuth : float
///     Direction of view about the vertical, degrees: 0 looks along x, 90 along y.
/// elevation : float
///     Direction of view above the horizon, degrees; negative looks down.
/// fovy : float
///     Vertical field of view, degrees.
#[pyclass(frozen, module = "clench")]
pub(crate) struct FreeCamera {
    /// list of float : The point in the middle of the picture (3,), m.
    #[pyo3(get)]
    pub(crate) lookat: [f64; 3],
    /// float : Distance from that point, m.
    #[pyo3(get)]
    pub(crate) distance: f64,
    /// float : Direction of view about the vertical, degrees.
    #[pyo3(get)]
    pub(crate) azimuth: f64,
    /// float : Direction of view above the horizon, degrees.
    #[pyo3(get)]
    pub(crate) elevation: f64,
    /// float : Vertical field of view, degrees.
    #[pyo3(get)]
    pub(crate) fovy: f64,
}

#[pymethods]
impl FreeCamera {
    #[new]
    #[pyo3(signature = (lookat, distance, azimuth = 90.0, elevation = -45.0, *, fovy = 45.0),
           text_signature = "(lookat, distance, azimuth=90.0, elevation=-45.0, *, fovy=45.0)")]
    fn new(
        lookat: &Bound<'_, PyAny>,
        distance: f64,
        azimuth: f64,
        elevation: f64,
        fovy: f64,
    ) -> PyResult<Self> {
        let array = shaped::<f64>("lookat", lookat, &[3])?;
        let point = array.as_array();
        let camera = FreeCamera {
            lookat: [point[0], point[1], point[2]],
            distance,
            azimuth,
            elevation,
            fovy,
        };
        let numbers = camera
            .lookat
            .into_iter()
            .chain([distance, azimuth, elevation]);
        let finite = numbers.clone().all(f64::is_finite);
        if !finite || distance <= 0.0 || !(fovy > 0.0 && fovy < 180.0) {
            return Err(PyValueError::new_err(
                "a camera needs finite numbers, a distance above 0, and a field of view between 0 and 180 degrees",
            ));
        }
        Ok(camera)
    }
}
