//! Pictures of simulations as arrays.

use crate::arrays::shaped;
use crate::batch::{AnyBatch, Batch};
use crate::busy::lock;
use crate::error::{classes::ClenchError, sim_error};
use crate::kind::Kind;
use crate::model::Model;
use crate::row_sim::AnySim;
use crate::sim::Sim;
use crate::viewed::{Target, each_viewed};
use crate::viewer::check_env;
use clench_render::{Image, Picture, RenderError, Renderer, View};
use clench_view::Viewed;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::{Arc, PoisonError};

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
pub(crate) struct FreeCamera(clench_render::FreeCamera);

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
        let camera = clench_render::FreeCamera {
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
        Ok(FreeCamera(camera))
    }

    /// list of float : The point in the middle of the picture (3,), m.
    #[getter]
    fn lookat(&self) -> [f64; 3] {
        self.0.lookat
    }
    /// float : How far from it, m.
    #[getter]
    fn distance(&self) -> f64 {
        self.0.distance
    }
    /// float : Direction of view about the vertical, degrees.
    #[getter]
    fn azimuth(&self) -> f64 {
        self.0.azimuth
    }
    /// float : Direction of view above the horizon, degrees.
    #[getter]
    fn elevation(&self) -> f64 {
        self.0.elevation
    }
    /// float : Vertical field of view, degrees.
    #[getter]
    fn fovy(&self) -> f64 {
        self.0.fovy
    }
}

/// What of a picture is wanted, and how it is asked for.
struct Wanted {
    picture: Picture,
    kind: Channel,
}

#[derive(Clone, Copy, PartialEq)]
enum Channel {
    Colors,
    Depth,
    Geoms,
}

impl Wanted {
    fn new(
        model: &clench::Model,
        (width, height): (u32, u32),
        camera: Option<&Bound<'_, PyAny>>,
        kind: &str,
        groups: Option<Vec<usize>>,
    ) -> PyResult<Self> {
        let kind = match kind {
            "rgb" => Channel::Colors,
            "depth" => Channel::Depth,
            "geom" => Channel::Geoms,
            other => {
                return Err(PyValueError::new_err(format!(
                    "kind is {other:?}, but must be \"rgb\", \"depth\" or \"geom\""
                )));
            }
        };
        let view = camera.map(|camera| match camera.cast::<FreeCamera>() {
            Ok(free) => Ok(View::Free(free.get().0)),
            Err(_) => Kind::Camera.find(model, camera).map(View::Camera),
        });
        let mut picture = Picture::new(width, height);
        picture.view = view.transpose()?;
        picture.colors = kind == Channel::Colors;
        picture.facts = !picture.colors;
        if let Some(groups) = groups {
            picture.groups = groups;
        }
        Ok(Wanted { picture, kind })
    }

    /// Draws an environment.
    fn draw<'py>(
        &self,
        py: Python<'py>,
        model: &Model,
        target: &Target,
        env: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut renderer = (model.renderer().lock()).unwrap_or_else(PoisonError::into_inner);
        if renderer.is_none() {
            let made = py.detach(|| Renderer::new(model.inner()));
            *renderer = Some(made.map_err(render_error)?);
        }
        let Some(renderer) = &mut *renderer else {
            return Err(ClenchError::new_err("nothing draws"));
        };
        let drawn = each_viewed!(target, viewed => py.detach(|| {
            viewed.ask(env, |sim| renderer.draw(sim, &self.picture))
        }));
        self.array(py, drawn.map_err(sim_error)?.map_err(render_error)?)
    }

    fn array<'py>(&self, py: Python<'py>, image: Image) -> PyResult<Bound<'py, PyAny>> {
        let (height, width) = (image.height, image.width);
        Ok(match self.kind {
            Channel::Colors => PyArray1::from_vec(py, image.rgb)
                .reshape([height, width, 3])?
                .into_any(),
            Channel::Depth => PyArray1::from_vec(py, image.depth)
                .reshape([height, width])?
                .into_any(),
            Channel::Geoms => PyArray1::from_vec(py, image.geoms)
                .reshape([height, width])?
                .into_any(),
        })
    }
}

fn render_error(error: RenderError) -> PyErr {
    match error {
        RenderError::Sim(error) => sim_error(error),
        RenderError::Size(..) | RenderError::NoCamera(..) => {
            PyValueError::new_err(error.to_string())
        }
        RenderError::NoDevice(_) | RenderError::Failed(..) => {
            ClenchError::new_err(error.to_string())
        }
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
    ///     No device that draws, and what to install.
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
        let wanted = Wanted::new(self.described(), (width, height), camera, kind, groups)?;
        let target = Target::Sim(Arc::clone(self.shared()));
        wanted.draw(py, self.py_model().get(), &target, 0)
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
        let wanted = Wanted::new(self.described(), (width, height), camera, kind, groups)?;
        let target = Target::Batch(Arc::clone(self.shared()));
        wanted.draw(py, self.py_model().get(), &target, env)
    }
}
