//! Pictures of simulations as arrays.

use crate::batch::Batch;
use crate::busy::lock;
use crate::drawing::{Wanted, draw};
use crate::sim::Sim;
use crate::viewed::Target;
use crate::viewer::check_env;
use pyo3::prelude::*;
use std::sync::Arc;

#[pymethods]
impl Sim {
    /// Renders a picture of the current state, without a window, on a GPU or, if there is none, with Mesa.
    ///
    /// Geoms have the sizes of the model, regardless of `set_param`. Sites, skins and image textures are not drawn.
    ///
    /// Parameters
    /// ----------
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, optional
    ///     A camera of the model by name or index, or a free one; by default everything that moves is in view.
    /// kind : {"rgb", "depth", "geom"}
    ///     The quantity of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms that are visible; 0, 1 and 2 by default, as in MuJoCo.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     "rgb": colours (height, width, 3), uint8. "depth": distances along the viewing direction (height, width), m,
    ///     float32, infinite where there is no geom. "geom": indices of geoms (height, width), int32, -1 for none.
    ///
    /// Raises
    /// ------
    /// ClenchError
    ///     If no device can draw; the message says what to install. Also if the package was built without rendering;
    ///     the message says how to build it with that.
    /// ValueError
    ///     If the size is invalid, or no camera has the name.
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
    /// Renders a picture of one environment in its current state; see `Sim.render`.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     The index of the environment.
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, optional
    ///     A camera of the model by name or index, or a free one; by default everything that moves is in view.
    /// kind : {"rgb", "depth", "geom"}
    ///     The quantity of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms that are visible; 0, 1 and 2 by default, as in MuJoCo.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     As for `Sim.render`.
    #[pyo3(signature = (env, width = 640, height = 480, *, camera = None, kind = "rgb", groups = None))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
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
        let model = {
            let guard = lock(self.shared(), "batch")?;
            self.model_of(&guard, env).clone_ref(py)
        };
        let target = Target::Batch(Arc::clone(self.shared()));
        draw(py, model.get(), (&target, env), wanted)
    }
}
