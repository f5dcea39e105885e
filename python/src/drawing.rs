//! Pictures as arrays.

use crate::arrays::memory;
use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::envs::{Envs, Scene};
use crate::error::{classes::ClenchError, sim_error};
use crate::free_camera::FreeCamera;
use crate::kind::Kind;
use crate::looks::Appearance;
pub(crate) use crate::looks::appearance;
use crate::model::Model;
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use clench_render::{Looks, Picture, Planes, RayCaster, RenderError, Renderer, View};
use clench_view::Viewed;
use numpy::{Element, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArrayMethods, dtype};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};
use std::sync::{Arc, PoisonError};

/// The number of environments between two checks for Ctrl-C.
const UNINTERRUPTED: usize = 64;

/// The pictures that a user requests.
pub(crate) struct DrawRequest<'a, 'py> {
    /// The model, or the common layout of several.
    pub(crate) layout: &'a clench::Model,
    /// The number of environments of a batch.
    pub(crate) n: Option<usize>,
    /// Width and height.
    pub(crate) size: (u32, u32),
    /// A camera or several.
    pub(crate) camera: Option<&'a Bound<'py, PyAny>>,
    pub(crate) kind: &'a str,
    /// The drawer; by default a graphics device, or rays if there is none.
    pub(crate) device: Option<&'a str>,
    /// The number of threads that cast rays.
    pub(crate) threads: usize,
    pub(crate) groups: Option<Vec<usize>>,
    pub(crate) out: Option<&'a Bound<'py, PyAny>>,
    pub(crate) appearance: Option<&'a Bound<'py, PyAny>>,
}

/// The drawer, as users choose it.
#[derive(Clone, Copy)]
enum Drawer {
    /// A graphics device or, if there is none, rays.
    Any,
    Device,
    Rays,
}

impl Drawer {
    fn new(device: Option<&str>) -> PyResult<Self> {
        match device {
            None => Ok(Drawer::Any),
            Some("gpu") => Ok(Drawer::Device),
            Some("cpu") => Ok(Drawer::Rays),
            Some(other) => Err(PyValueError::new_err(format!(
                "device is {other:?}, but pictures are by \"gpu\" or \"cpu\""
            ))),
        }
    }
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
    scenes: &[Scene],
    (target, envs): (&Target, &Envs),
    request: DrawRequest<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(Scene { model, .. }) = scenes.first() else {
        return Err(PyValueError::new_err("there is no model to draw"));
    };
    let cameras = Cameras::new(model.get().inner(), request.camera)?;
    let mut shape = Vec::new();
    shape.extend(envs.list.then_some(envs.of.len()));
    shape.extend(cameras.list.then_some(cameras.views.len()));
    shape.extend([request.size.1 as usize, request.size.0 as usize]);
    let mut picture = Picture::new(request.size.0, request.size.1);
    picture.views = cameras.views;
    if let Some(groups) = request.groups {
        picture.groups = groups;
    }
    // Several environments have an axis in a batch, whose model is the common layout.
    let read = |given: &Bound<'_, PyAny>| {
        let appearance = Appearance::new(request.layout, request.n, given)?;
        let mut models = scenes.iter().map(|scene| scene.model.get().inner());
        models.try_for_each(|model| appearance.check(request.layout, model))?;
        Ok::<_, PyErr>(appearance)
    };
    let call = DrawCall {
        scenes,
        target,
        envs,
        picture,
        drawer: Drawer::new(request.device)?,
        appearance: request.appearance.map(read).transpose()?,
        colors: request.kind == "rgb",
        threads: request.threads,
    };
    match request.kind {
        "rgb" => {
            shape.push(3);
            call.array(py, &shape, request.out, |rgb| Planes {
                rgb,
                ..Planes::default()
            })
        }
        "depth" => call.array(py, &shape, request.out, |depth| Planes {
            depth,
            ..Planes::default()
        }),
        "geom" => call.array(py, &shape, request.out, |geoms| Planes {
            geoms,
            ..Planes::default()
        }),
        other => Err(PyValueError::new_err(format!(
            "kind is {other:?}, but must be \"rgb\", \"depth\" or \"geom\""
        ))),
    }
}

/// A call with its arguments, apart from memory.
struct DrawCall<'a> {
    scenes: &'a [Scene],
    target: &'a Target,
    envs: &'a Envs,
    picture: Picture,
    drawer: Drawer,
    appearance: Option<Appearance>,
    colors: bool,
    threads: usize,
}

impl DrawCall<'_> {
    /// Draws into `out`, or into a new array.
    fn array<'py, S: Element>(
        &self,
        py: Python<'py>,
        shape: &[usize],
        out: Option<&Bound<'py, PyAny>>,
        planes: impl FnOnce(&mut [S]) -> Planes,
    ) -> PyResult<Bound<'py, PyAny>> {
        let by_rays = py.detach(|| self.is_by_rays())?;
        let out = match out {
            Some(out) => out.clone(),
            None => {
                let shape = PyTuple::new(py, shape)?;
                let numpy = py.import(intern!(py, "numpy"))?;
                numpy.call_method1("zeros", (shape, dtype::<S>(py)))?
            }
        };
        let mut memory = writable::<S>(&out, shape)?;
        let mut planes = planes(memory.as_slice_mut()?);
        for scene in self.scenes {
            match by_rays {
                true => self.cast(py, scene, planes.reborrow()),
                false => self.draw(py, scene, planes.reborrow()),
            }?;
        }
        Ok(out)
    }

    /// Returns true if rays make the pictures, after a check of their size: NumPy would report an impossible one as a
    /// lack of memory.
    fn is_by_rays(&self) -> Result<bool, Failure> {
        let colors = self.colors;
        if colors && matches!(self.drawer, Drawer::Rays) {
            return Err(Failure::Colors);
        }
        for scene in self.scenes {
            let model = scene.model.get();
            if !matches!(self.drawer, Drawer::Rays) {
                match with_renderer(model, |own| Ok(own.check_size(&self.picture)?)) {
                    Err(Failure::Render(RenderError::NoDevice(_)))
                        if !colors && matches!(self.drawer, Drawer::Any) => {}
                    Err(error) => return Err(error),
                    Ok(()) => continue,
                }
            }
            caster(model)?.check_size(&self.picture)?;
            return Ok(true);
        }
        Ok(false)
    }

    /// Draws the environments of a model on a graphics device.
    fn draw(&self, py: Python<'_>, scene: &Scene, planes: Planes) -> PyResult<()> {
        let (model, count) = (scene.model.get(), self.envs.of.len());
        each_viewed!(self.target, viewed => py.detach(|| with_renderer(model, |renderer| {
            let mut pictures = renderer.pictures(&self.picture, count, planes)?;
            self.each(viewed, scene, |sim, slot, looks| pictures.add(sim, slot, looks))?;
            Ok(pictures.finish()?)
        })))?;
        Ok(())
    }

    /// Draws the environments of a model by rays.
    fn cast(&self, py: Python<'_>, scene: &Scene, planes: Planes) -> PyResult<()> {
        let (model, count) = (scene.model.get(), self.envs.of.len());
        each_viewed!(self.target, viewed => py.detach(|| {
            let caster = caster(model)?;
            let mut pictures = caster.pictures(&self.picture, count, planes, self.threads)?;
            self.each(viewed, scene, |sim, slot, looks| pictures.add(sim, slot, looks))?;
            pictures.finish();
            Ok::<_, Failure>(())
        }))?;
        Ok(())
    }

    /// Adds a picture of each environment, and checks for Ctrl-C now and then.
    fn each<V: Viewed>(
        &self,
        viewed: &mut V,
        scene: &Scene,
        mut add: impl FnMut(
            &mut clench::Sim<V::Scalar>,
            usize,
            Option<&Looks>,
        ) -> Result<(), RenderError>,
    ) -> Result<(), Failure> {
        let mut looks = (self.appearance.as_ref())
            .map(|appearance| (appearance, Looks::of(scene.model.get().inner())));
        let mut add = |sim: &mut clench::Sim<V::Scalar>, slot: usize| {
            if slot % UNINTERRUPTED == UNINTERRUPTED - 1 {
                Python::attach(|py| py.check_signals())?;
            }
            if let Some((appearance, looks)) = &mut looks {
                appearance.apply(self.envs.of[slot], &scene.geoms, looks);
            }
            let looks = looks.as_ref().map(|(_, looks)| looks);
            Ok::<_, Failure>(add(sim, slot, looks)?)
        };
        let envs = scene.slots.iter().map(|&slot| self.envs.of[slot]);
        let (mut done, mut slots) = (Ok(()), scene.slots.iter());
        let viewed = viewed.query_each(envs, |_, sim| {
            if let (Ok(()), Some(&slot)) = (&done, slots.next()) {
                done = add(sim, slot);
            }
        });
        viewed.map_err(RenderError::from)?;
        done
    }
}

/// Calls a function with the renderer of a model. The interpreter must not be held: another thread may be drawing.
fn with_renderer<R>(
    model: &Model,
    call: impl FnOnce(&mut Renderer) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut renderers = (model.renderers().lock()).unwrap_or_else(PoisonError::into_inner);
    call(renderers.device.get(model.inner())?)
}

/// Returns the ray caster of a model. The interpreter must not be held.
fn caster(model: &Model) -> Result<Arc<RayCaster>, Failure> {
    let mut renderers = (model.renderers().lock()).unwrap_or_else(PoisonError::into_inner);
    let caster = match &mut renderers.rays {
        Some(caster) => caster,
        none => none.insert(Arc::new(RayCaster::new(model.inner())?)),
    };
    Ok(Arc::clone(caster))
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
pub(crate) fn render_device(py: Python<'_>) -> PyResult<Option<String>> {
    Ok(py.detach(clench_render::device_name))
}

/// Returns the memory of an array of this shape.
fn writable<'py, S: Element>(
    out: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadwriteArrayDyn<'py, S>> {
    let array = memory::<S>(out, shape)?;
    if !array.is_c_contiguous() {
        let text = "out must be contiguous in C order";
        return Err(PyValueError::new_err(text));
    }
    Ok(array.try_readwrite()?)
}

/// An error of drawing, or a signal.
enum Failure {
    Render(RenderError),
    /// Colours by rays.
    Colors,
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
            Failure::Colors => PyValueError::new_err(
                "device \"cpu\" casts rays, which see no colours: kind must be \"depth\" or \"geom\"",
            ),
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
