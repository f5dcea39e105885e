//! Pictures of simulations as arrays.

use crate::arrays::shaped;
use crate::batch::Batch;
use crate::drawing::{Wanted, draw};
use crate::sim::Sim;
use crate::viewed::Target;
use crate::viewer::check_env;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

/// A camera that belongs to no model, as MuJoCo's free one: it looks at a point from a distance and a direction.
///
/// Parameters
/// ----------
/// lookat : array_like
///     The point in the middle of the picture (3,), m.
/// distance : float
///     How far from it, m.
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
    /// float : How far from it, m.
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

#[pymethods]
impl Sim {
    /// A picture of the present state, drawn without a window by a graphics card or, where there is none, by Mesa.
    ///
    /// Geoms have the sizes of the model, whatever `set_param` changed; not drawn are sites, skins, and pictures of files on surfaces.
    ///
    /// Parameters
    /// ----------
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, optional
    ///     A camera of the model by name or index, or one of your own; without it all that moves is seen.
    /// kind : {"rgb", "depth", "geom"}
    ///     What is wanted of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms that are seen; 0, 1 and 2 if not given, as in MuJoCo.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     "rgb": colours (height, width, 3), uint8. "depth": distances along the direction in which the camera looks (height,
    ///     width), m, float32, infinite where nothing is. "geom": geoms (height, width), int32, -1 for none.
    ///
    /// Raises
    /// ------
    /// ClenchError
    ///     No device that draws, and what to install; a package that was built without pictures, and how to build it with them.
    /// ValueError
    ///     A size that no picture can have; a name that no camera has.
    #[pyo3(signature = (width = 640, height = 480, *, camera = None, kind = "rgb", groups = None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        width: u32,
        height: u32,
        camera: Option<&Bound<'py, PyAny>>,
        kind: &str,
        groups: Option<Vec<usize>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let wanted = Wanted {
            size: (width, height),
            camera,
            kind,
            groups,
        };
        let target = Target::Sim(Arc::clone(self.shared()));
        draw(py, self.py_model().get(), (&target, 0), wanted)
    }
}

#[pymethods]
impl Batch {
    /// A picture of one environment in its present state, as `Sim.render`.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     Which environment.
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, optional
    ///     A camera of the model by name or index, or one of your own; without it all that moves is seen.
    /// kind : {"rgb", "depth", "geom"}
    ///     What is wanted of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms that are seen; 0, 1 and 2 if not given, as in MuJoCo.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     As of `Sim.render`.
    #[pyo3(signature = (env, width = 640, height = 480, *, camera = None, kind = "rgb", groups = None))]
    #[allow(clippy::too_many_arguments)] // Named ones, to Python.
    fn render<'py>(
        &self,
        py: Python<'py>,
        env: usize,
        width: u32,
        height: u32,
        camera: Option<&Bound<'py, PyAny>>,
        kind: &str,
        groups: Option<Vec<usize>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        check_env(env, self.count())?;
        let wanted = Wanted {
            size: (width, height),
            camera,
            kind,
            groups,
        };
        let target = Target::Batch(Arc::clone(self.shared()));
        draw(py, self.py_model().get(), (&target, env), wanted)
    }
}
