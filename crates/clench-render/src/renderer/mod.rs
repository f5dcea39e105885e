//! A renderer of a model's simulations.

mod draw;
mod pictures;

use crate::camera::View;
use crate::canvas::{Canvas, Form};
use crate::device::{Gpu, RenderError};
use crate::image::{Image, Planes};
use crate::passes::Passes;
use crate::scene::Scene;
use clench::Model;
use clench::rigid::{Precision, Sim};
pub use pictures::Pictures;
use std::sync::Arc;

/// The maximum number of pixels of a side.
pub(crate) const MAX_SIDE: u32 = 8192;
/// The number of forms of pictures whose textures are stored: a training loop alternates between a few.
const MAX_CANVASES: usize = 4;

/// The settings of the pictures of a simulation.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The views, a picture each.
    pub views: Vec<View>,
    /// The width, pixels.
    pub width: u32,
    /// The height, pixels.
    pub height: u32,
    /// The visible groups of geoms and sites.
    pub groups: Vec<usize>,
}

impl Picture {
    /// Creates settings for a picture of all movable geoms in the groups 0 to 2, which MuJoCo also shows.
    pub fn new(width: u32, height: u32) -> Self {
        Picture {
            views: vec![View::All],
            width,
            height,
            groups: vec![0, 1, 2],
        }
    }

    /// Returns the number of pixels of the pictures of `count` simulations; `None` if no memory can have so many.
    pub fn pixels(&self, count: usize) -> Option<usize> {
        let sides = [self.width as usize, self.height as usize];
        let sizes = [count, self.views.len()].into_iter().chain(sides);
        sizes.into_iter().try_fold(1usize, usize::checked_mul)
    }

    /// Returns an error unless each side has 1 to `max` pixels.
    pub(crate) fn check_sides(&self, max: u32) -> Result<(), RenderError> {
        let sides = [self.width, self.height];
        match sides.iter().all(|side| (1..=max).contains(side)) {
            true => Ok(()),
            false => Err(RenderError::Size(self.width, self.height, max)),
        }
    }

    /// Panics if memory that is not empty has another size than the pictures of `count` simulations.
    pub(crate) fn check_memory(&self, count: usize, out: &Planes) {
        let pixels = self.pixels(count);
        for (len, each) in [
            (out.rgb.len(), 3),
            (out.depth.len(), 1),
            (out.geoms.len(), 1),
        ] {
            let fits = len == 0 || Some(len) == pixels.and_then(|pixels| pixels.checked_mul(each));
            assert!(fits, "the memory has another size than the pictures");
        }
    }
}

/// A model on a GPU, which draws its simulations.
pub struct Renderer {
    gpu: Gpu,
    passes: Passes,
    scene: Scene,
    /// The textures of the last forms of pictures, the latest last.
    canvases: Vec<Canvas>,
}

impl Renderer {
    /// Uploads the shapes of a model to a GPU.
    ///
    /// # Errors
    /// Returns an error with a remedy if no device can draw.
    pub fn new(model: &Arc<Model>) -> Result<Self, RenderError> {
        let gpu = Gpu::open()?;
        let passes = Passes::new(&gpu.device, !model.visuals.lights.is_empty());
        Ok(Renderer {
            scene: Scene::new(&gpu, &passes, model)?,
            gpu,
            passes,
            canvases: Vec::new(),
        })
    }

    /// Returns the name of the device.
    pub fn device(&self) -> &str {
        &self.gpu.name
    }

    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        &self.scene.model
    }

    /// Draws the colours of the present state of a simulation of the model.
    ///
    /// # Errors
    /// Returns an error if the size is out of range, the camera does not exist, the state cannot be evaluated, or the
    /// device fails.
    pub fn draw<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        wanted: &Picture,
    ) -> Result<Image, RenderError> {
        self.image(sim, wanted, true, false)
    }

    /// Draws the colours, distances and geom indices of the present state of a simulation of the model.
    ///
    /// # Errors
    /// See [`draw`](Self::draw).
    pub fn draw_facts<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        wanted: &Picture,
    ) -> Result<Image, RenderError> {
        self.image(sim, wanted, true, true)
    }

    fn image<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        wanted: &Picture,
        colors: bool,
        facts: bool,
    ) -> Result<Image, RenderError> {
        self.check_size(wanted)?;
        let pixels = wanted.pixels(1).unwrap_or_default();
        let of = |asked: bool| if asked { pixels } else { 0 };
        let mut image = Image {
            width: wanted.width as usize,
            height: wanted.height as usize,
            rgb: vec![0; 3 * of(colors)],
            depth: vec![0.0; of(facts)],
            geoms: vec![0; of(facts)],
        };
        let planes = Planes {
            rgb: &mut image.rgb,
            depth: &mut image.depth,
            geoms: &mut image.geoms,
        };
        let mut pictures = self.pictures(wanted, 1, planes)?;
        pictures.add(sim, 0, None)?;
        pictures.finish()?;
        Ok(image)
    }

    /// Begins the pictures of `count` simulations, which are written into memory.
    ///
    /// # Errors
    /// Returns an error if the size is out of range.
    ///
    /// # Panics
    /// Panics if memory that is not empty has another size than the pictures.
    pub fn pictures<'a>(
        &'a mut self,
        wanted: &'a Picture,
        count: usize,
        out: Planes<'a>,
    ) -> Result<Pictures<'a>, RenderError> {
        self.check_size(wanted)?;
        Ok(Pictures::new(self, wanted, count, out))
    }

    /// Checks the size of pictures.
    ///
    /// # Errors
    /// Returns an error if it is out of range.
    pub fn check_size(&self, wanted: &Picture) -> Result<(), RenderError> {
        let max = MAX_SIDE.min(self.gpu.device.limits().max_texture_dimension_2d);
        wanted.check_sides(max)
    }

    /// Takes the textures of a form out of the renderer, or creates them.
    fn take_canvas(&mut self, form: Form, pictures: usize) -> Canvas {
        let pictures = form.pictures(pictures);
        let fits = |canvas: &Canvas| canvas.form == form && canvas.pictures >= pictures;
        if let Some(index) = self.canvases.iter().position(fits) {
            return self.canvases.remove(index);
        }
        self.canvases.retain(|canvas| canvas.form != form);
        Canvas::new(&self.gpu, &self.passes, form, pictures)
    }

    /// Stores textures for later pictures.
    fn store_canvas(&mut self, canvas: Canvas) {
        self.canvases.push(canvas);
        let old = self.canvases.len().saturating_sub(MAX_CANVASES);
        self.canvases.drain(..old);
    }
}
