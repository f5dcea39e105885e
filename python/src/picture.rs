//! Pictures of simulations as arrays.

use crate::batch::Batch;
use crate::drawing::{Wanted, draw};
use crate::sim::Sim;
use crate::viewed::Target;
use crate::viewer::check_env;
use pyo3::prelude::*;
use std::sync::Arc;

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
