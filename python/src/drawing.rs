//! Pictures as arrays.

use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::error::{classes::ClenchError, sim_error};
use crate::free_camera::FreeCamera;
use crate::kind::Kind;
use crate::model::Model;
use crate::renderer::Renderer;
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use clench_render::{Image, Picture, RenderError, View};
use clench_view::Viewed;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::PoisonError;

/// The picture that a user requests.
pub(crate) struct Wanted<'a, 'py> {
    /// Width and height.
    pub(crate) size: (u32, u32),
    pub(crate) camera: Option<&'a Bound<'py, PyAny>>,
    pub(crate) kind: &'a str,
    pub(crate) groups: Option<Vec<usize>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Channel {
    Colors,
    Depth,
    Geoms,
}

impl Wanted<'_, '_> {
    fn picture(self, model: &clench::Model) -> PyResult<(Picture, Channel)> {
        let channel = match self.kind {
            "rgb" => Channel::Colors,
            "depth" => Channel::Depth,
            "geom" => Channel::Geoms,
            other => {
                return Err(PyValueError::new_err(format!(
                    "kind is {other:?}, but must be \"rgb\", \"depth\" or \"geom\""
                )));
            }
        };
        let view = |camera: &Bound<'_, PyAny>| match camera.cast::<FreeCamera>() {
            Ok(free) => Ok(View::Free(free.get().into())),
            Err(_) => Kind::Camera.find(model, camera).map(View::Camera),
        };
        let mut picture = Picture::new(self.size.0, self.size.1);
        picture.view = self.camera.map(view).transpose()?;
        picture.colors = channel == Channel::Colors;
        picture.facts = !picture.colors;
        if let Some(groups) = self.groups {
            picture.groups = groups;
        }
        Ok((picture, channel))
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

/// Draws one environment.
pub(crate) fn draw<'py>(
    py: Python<'py>,
    model: &Model,
    (target, env): (&Target, usize),
    wanted: Wanted<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let (picture, channel) = wanted.picture(model.inner())?;
    let mut renderer = (model.renderer().lock()).unwrap_or_else(PoisonError::into_inner);
    if renderer.is_none() {
        let made = py.detach(|| Renderer::new(model.inner()));
        *renderer = Some(made.map_err(render_error)?);
    }
    let Some(renderer) = &mut *renderer else {
        return Err(ClenchError::new_err("nothing draws"));
    };
    let drawn = each_viewed!(target, viewed => py.detach(|| {
        viewed.query(env, |sim| renderer.draw(sim, &picture))
    }));
    array(
        py,
        channel,
        drawn.map_err(sim_error)?.map_err(render_error)?,
    )
}

fn array(py: Python<'_>, channel: Channel, image: Image) -> PyResult<Bound<'_, PyAny>> {
    let (height, width) = (image.height, image.width);
    Ok(match channel {
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
