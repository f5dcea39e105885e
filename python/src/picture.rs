//! Pictures of simulations as arrays.

use crate::arrays::indices;
use crate::batch::{AnyBatch, Batch, each};
use crate::busy::lock;
use crate::count::Pixels;
use crate::drawing::{DrawRequest, appearance, draw};
use crate::envs::{Envs, Scene};
use crate::error::sim_error;
use crate::model::Model;
use crate::sim::Sim;
use crate::viewed::Target;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// Reads the groups of geoms that are visible.
fn chosen_groups(groups: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    indices("groups", groups, 6)
}

#[pymethods]
impl Model {
    /// Returns the colours and lights of pictures, to be changed and passed to `Sim.render` or `Batch.render`. They do
    /// not affect physics. Of several models, geoms are those of the common layout.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    ///     ``geom_rgba`` (ngeom, 4) and ``site_rgba`` (nsite, 4): red, green, blue and opacity, 0 to 1; 0 hides it.
    ///     ``light_pos``, m, and ``light_dir`` (nlight, 3), in the frame of the light's body; they do not matter where
    ///     its mode replaces them. ``light_ambient``, ``light_diffuse`` and ``light_specular`` (nlight, 3) and
    ///     ``headlight_ambient``, ``headlight_diffuse`` and ``headlight_specular`` (3,): colours, from 0. A model
    ///     without lights is in daylight, which no headlight changes.
    ///
    /// Raises
    /// ------
    /// ClenchError
    ///     If the package was built without rendering; the message says how to build it with that.
    fn appearance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        appearance(py, self)
    }
}

#[pymethods]
impl Sim {
    /// Renders a picture of the current state, without a window, on a GPU or, if there is none, with Mesa. Rays on the
    /// processor find distances and geoms without either.
    ///
    /// On a device geoms have the sizes of the model, regardless of `set_param`. Skins are not drawn. Pictures of rays
    /// differ from those of a device at the edges of geoms, by less than a pixel.
    ///
    /// Parameters
    /// ----------
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, or a sequence of these, optional
    ///     A camera of the model by name or index, or a free one; by default everything that moves is in view. Several
    ///     give an array with an axis of cameras in front.
    /// kind : {"rgb", "depth", "geom"}
    ///     The quantity of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms, 0 to 5, that are visible; 0, 1 and 2 by default, as in MuJoCo.
    /// out : numpy.ndarray or tensor, optional
    ///     The contiguous array to write to, or a tensor that shares its memory by DLPack.
    /// device : {"gpu", "cpu"}, optional
    ///     "gpu": a graphics device, or Mesa's software device. "cpu": rays on the processor, for "depth" and "geom"
    ///     only. By default the first; if there is none (see `render_device`), rays.
    /// appearance : dict, optional
    ///     Colours and lights in place of the model's: arrays by name, as in `Model.appearance`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     `out`, or a new array. "rgb": colours (height, width, 3), uint8. "depth": distances along the viewing
    ///     direction (height, width), m, float32, infinite where there is no geom. "geom": indices of geoms
    ///     (height, width), int32, -1 for none.
    ///
    /// Raises
    /// ------
    /// ClenchError
    ///     If colours are requested, or device "gpu", and no device can draw; the message says what to install. Also if
    ///     the package was built without rendering; the message says how to build it with that.
    /// ValueError
    ///     If the size is invalid, no camera has the name, `out` has another shape, rays should see colours, or
    ///     the appearance has an unknown name, a wrong shape or an invalid number.
    /// IndexError
    ///     If an index of a camera or a group is out of range.
    /// TypeError
    ///     If `out` has another dtype.
    #[pyo3(signature = (width = Pixels(640), height = Pixels(480), *, camera = None, kind = "rgb", groups = None,
                        out = None, device = None, appearance = None),
           text_signature = "($self, width=640, height=480, *, camera=None, kind='rgb', groups=None, out=None, device=None, appearance=None)")]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn render<'py>(
        &self,
        py: Python<'py>,
        width: Pixels,
        height: Pixels,
        camera: Option<&Bound<'py, PyAny>>,
        kind: &str,
        groups: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
        device: Option<&str>,
        appearance: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let request = DrawRequest {
            layout: self.described(),
            n: None,
            size: (width.0, height.0),
            camera,
            kind,
            device,
            threads: 1,
            groups: groups.map(chosen_groups).transpose()?,
            out,
            appearance,
        };
        let target = Target::Sim(Arc::clone(self.shared()));
        let own = Envs {
            of: vec![0],
            list: false,
        };
        let model = self.py_model();
        let scenes = [Scene {
            model: model.clone_ref(py),
            slots: vec![0],
            geoms: Vec::from_iter(0..model.get().inner().geoms.len()),
        }];
        draw(py, &scenes, (&target, &own), request)
    }
}

impl Batch {
    /// Returns the models of some environments.
    fn scenes(&self, py: Python<'_>, envs: &Envs) -> PyResult<Vec<Scene>> {
        let guard = lock(self.shared(), "batch")?;
        let of = Vec::from_iter(envs.of.iter().map(|&env| self.model_of(&guard, env)));
        let mut scenes = Vec::new();
        for (index, model) in self.objects().iter().enumerate() {
            let own = of.iter().enumerate().filter(|(_, of)| of.is(model));
            let slots = Vec::from_iter(own.map(|(slot, _)| slot));
            // Without environments, the first model still checks the arguments.
            if slots.is_empty() && !(of.is_empty() && index == 0) {
                continue;
            }
            let geoms = each!(&*guard, batch => batch.geoms_of(index));
            scenes.push(Scene {
                model: model.clone_ref(py),
                slots,
                geoms: geoms.map_err(sim_error)?,
            });
        }
        Ok(scenes)
    }
}

#[pymethods]
impl Batch {
    /// Renders environments in their current states, many at a time; see `Sim.render`.
    ///
    /// Each picture has the bits of one that is rendered alone.
    ///
    /// Parameters
    /// ----------
    /// env : int or array_like of int, optional
    ///     The index of the environment, or of several; by default all.
    /// width, height : int
    ///     Pixels.
    /// camera : str, int or FreeCamera, or a sequence of these, optional
    ///     A camera of the model by name or index, or a free one; by default everything that moves is in view.
    /// kind : {"rgb", "depth", "geom"}
    ///     The quantity of each pixel.
    /// groups : sequence of int, optional
    ///     The groups of geoms, 0 to 5, that are visible; 0, 1 and 2 by default, as in MuJoCo.
    /// out : numpy.ndarray or tensor, optional
    ///     The contiguous array to write to, or a tensor that shares its memory by DLPack.
    /// device : {"gpu", "cpu"}, optional
    ///     "gpu": a graphics device, or Mesa's software device. "cpu": rays on the processor, for "depth" and "geom"
    ///     only. By default the first; if there is none (see `render_device`), rays.
    /// appearance : dict, optional
    ///     Colours and lights in place of the model's: arrays by name, each in its shape in `Model.appearance`, or with
    ///     an axis of all environments of the batch in front.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     As for `Sim.render`, with an axis of environments in front unless `env` is an int. With several cameras the
    ///     next axis is theirs: (n, cameras, height, width, 3).
    ///
    /// Raises
    /// ------
    /// ClenchError, TypeError, ValueError
    ///     As for `Sim.render`.
    /// IndexError
    ///     If an index of an environment, a camera or a group is out of range.
    #[pyo3(signature = (env = None, width = Pixels(640), height = Pixels(480), *, camera = None, kind = "rgb",
                        groups = None, out = None, device = None, appearance = None),
           text_signature = "($self, env=None, width=640, height=480, *, camera=None, kind='rgb', groups=None, out=None, device=None, appearance=None)")]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn render<'py>(
        &self,
        py: Python<'py>,
        env: Option<&Bound<'py, PyAny>>,
        width: Pixels,
        height: Pixels,
        camera: Option<&Bound<'py, PyAny>>,
        kind: &str,
        groups: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
        device: Option<&str>,
        appearance: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let envs = Envs::new(self, env)?;
        let request = DrawRequest {
            layout: self.described(),
            n: Some(self.count()),
            size: (width.0, height.0),
            camera,
            kind,
            device,
            threads: self.threads(),
            groups: groups.map(chosen_groups).transpose()?,
            out,
            appearance,
        };
        let scenes = self.scenes(py, &envs)?;
        let target = Target::Batch(Arc::clone(self.shared()));
        draw(py, &scenes, (&target, &envs), request)
    }
}
