//! Pictures as arrays.

use crate::arrays::require_shape;
use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::envs::{Envs, Scenes};
use crate::error::{classes::ClenchError, sim_error};
use crate::free_camera::FreeCamera;
use crate::kind::Kind;
use crate::model::Model;
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use clench::Precision;
use clench_render::{Picture, Pictures, Planes, RenderError, Renderer, View};
use clench_view::Viewed;
use numpy::{
    Element, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};
use std::sync::PoisonError;

/// The number of environments between two checks for Ctrl-C.
const UNINTERRUPTED: usize = 64;

/// The pictures that a user requests.
pub(crate) struct Wanted<'a, 'py> {
    /// Width and height.
    pub(crate) size: (u32, u32),
    /// A camera or several.
    pub(crate) camera: Option<&'a Bound<'py, PyAny>>,
    pub(crate) kind: &'a str,
    pub(crate) groups: Option<Vec<usize>>,
    pub(crate) out: Option<&'a Bound<'py, PyAny>>,
}

/// The cameras of an argument, and whether it is a list.
struct Cameras {
    views: Vec<View>,
    list: bool,
}

impl Cameras {
    fn new(model: &clench::Model, camera: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(camera) = camera else {
            return Ok(Cameras {
                views: vec![View::All],
                list: false,
            });
        };
        let view = |camera: &Bound<'_, PyAny>| match camera.cast::<FreeCamera>() {
            Ok(free) => Ok(View::Free(free.get().into())),
            Err(_) if camera.is_none() => Ok(View::All),
            Err(_) => Kind::Camera.find(model, camera).map(View::Camera),
        };
        if !camera.is_instance_of::<PyString>()
            && let Ok(cameras) = camera.try_iter()
        {
            return Ok(Cameras {
                views: cameras
                    .map(|camera| view(&camera?))
                    .collect::<PyResult<_>>()?,
                list: true,
            });
        }
        Ok(Cameras {
            views: vec![view(camera)?],
            list: false,
        })
    }
}

impl From<&FreeCamera> for clench_render::FreeCamera {
    fn from(camera: &FreeCamera) -> Self {
        clench_render::FreeCamera {
            lookat: camera.lookat,
            distance: camera.distance,
            azimuth: camera.azimuth,
            elevation: camera.elevation,
            fovy: camera.fovy,
        }
    }
}

/// Draws environments.
pub(crate) fn draw<'py>(
    py: Python<'py>,
    scenes: &Scenes,
    (target, envs): (&Target, &Envs),
    wanted: Wanted<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some((model, _)) = scenes.first() else {
        return Err(PyValueError::new_err("there is no model to draw"));
    };
    let cameras = Cameras::new(model.get().inner(), wanted.camera)?;
    let mut shape = Vec::new();
    shape.extend(envs.list.then_some(envs.of.len()));
    shape.extend(cameras.list.then_some(cameras.views.len()));
    shape.extend([wanted.size.1 as usize, wanted.size.0 as usize]);
    let mut picture = Picture::new(wanted.size.0, wanted.size.1);
    picture.views = cameras.views;
    if let Some(groups) = wanted.groups {
        picture.groups = groups;
    }
    let asked = Asked {
        scenes,
        target,
        envs,
        picture,
    };
    match wanted.kind {
        "rgb" => {
            shape.push(3);
            asked.array(py, &shape, wanted.out, |rgb| Planes {
                rgb,
                ..Planes::default()
            })
        }
        "depth" => asked.array(py, &shape, wanted.out, |depth| Planes {
            depth,
            ..Planes::default()
        }),
        "geom" => asked.array(py, &shape, wanted.out, |geoms| Planes {
            geoms,
            ..Planes::default()
        }),
        other => Err(PyValueError::new_err(format!(
            "kind is {other:?}, but must be \"rgb\", \"depth\" or \"geom\""
        ))),
    }
}

/// A call with its arguments, apart from memory.
struct Asked<'a> {
    scenes: &'a Scenes,
    target: &'a Target,
    envs: &'a Envs,
    picture: Picture,
}

impl Asked<'_> {
    /// Draws into `out`, or into a new array.
    fn array<'py, S: Element>(
        &self,
        py: Python<'py>,
        shape: &[usize],
        out: Option<&Bound<'py, PyAny>>,
        planes: impl FnOnce(&mut [S]) -> Planes,
    ) -> PyResult<Bound<'py, PyAny>> {
        // NumPy would report an impossible size as a lack of memory.
        for (model, _) in self.scenes {
            let model = model.get();
            py.detach(|| with_renderer(model, |own| Ok(own.check_size(&self.picture)?)))?;
        }
        let out = match out {
            Some(out) => out.clone(),
            None => {
                let shape = PyTuple::new(py, shape)?;
                let numpy = py.import(intern!(py, "numpy"))?;
                numpy.call_method1("zeros", (shape, dtype::<S>(py)))?
            }
        };
        let mut memory = writable::<S>(&out, shape)?;
        self.draw(py, planes(memory.as_slice_mut()?))?;
        Ok(out)
    }

    /// Draws all environments, one model after another.
    fn draw(&self, py: Python<'_>, mut planes: Planes) -> PyResult<()> {
        let count = self.envs.of.len();
        for (model, slots) in self.scenes {
            let model = model.get();
            let envs = slots.iter().map(|&slot| self.envs.of[slot]);
            each_viewed!(self.target, viewed => py.detach(|| with_renderer(model, |renderer| {
                let mut pictures = renderer.pictures(&self.picture, count, planes.reborrow())?;
                let mut done = Ok(());
                let mut slots = slots.iter();
                viewed.query_each(envs, |_, sim| {
                    if let (Ok(()), Some(&slot)) = (&done, slots.next()) {
                        done = add(&mut pictures, sim, slot);
                    }
                }).map_err(RenderError::from)?;
                done?;
                Ok(pictures.finish()?)
            })))?;
        }
        Ok(())
    }
}

/// Adds a picture, and checks for Ctrl-C now and then.
fn add<T: Precision>(
    pictures: &mut Pictures,
    sim: &mut clench::Sim<T>,
    slot: usize,
) -> Result<(), Failure> {
    if slot % UNINTERRUPTED == UNINTERRUPTED - 1 {
        Python::attach(|py| py.check_signals())?;
    }
    Ok(pictures.add(sim, slot)?)
}

/// Calls a function with the renderer of a model. The interpreter must not be held: another thread may be drawing.
fn with_renderer<R>(
    model: &Model,
    call: impl FnOnce(&mut Renderer) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut renderer = (model.renderer().lock()).unwrap_or_else(PoisonError::into_inner);
    match &mut *renderer {
        Some(renderer) => call(renderer),
        none => call(none.insert(Renderer::new(model.inner())?)),
    }
}

/// Returns the memory of an array of this shape.
fn writable<'py, S: Element>(
    out: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadwriteArrayDyn<'py, S>> {
    let Ok(array) = out.cast::<PyArrayDyn<S>>() else {
        let name = dtype::<S>(out.py());
        return Err(PyTypeError::new_err(format!(
            "out must be an array of {name}"
        )));
    };
    require_shape("out", array.shape(), shape)?;
    if !array.is_c_contiguous() {
        let text = "out must be contiguous in C order";
        return Err(PyValueError::new_err(text));
    }
    Ok(array.try_readwrite()?)
}

/// An error of drawing, or a signal.
enum Failure {
    Render(RenderError),
    Python(PyErr),
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Failure::Render(error)
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Failure::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Python(error) => error,
            Failure::Render(RenderError::Sim(error)) => sim_error(error),
            Failure::Render(error @ (RenderError::Size(..) | RenderError::NoCamera(..))) => {
                PyValueError::new_err(error.to_string())
            }
            Failure::Render(error @ (RenderError::NoDevice(_) | RenderError::Failed(..))) => {
                ClenchError::new_err(error.to_string())
            }
        }
    }
}
