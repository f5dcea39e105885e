//! Distances and geom indices by rays on the processor: the facts that a [`Renderer`](crate::Renderer) draws, without a
//! graphics device. A ray passes through the middle of each pixel.

mod cast;
mod eye;
mod target;

use crate::camera::FreeCamera;
use crate::device::RenderError;
use crate::image::Planes;
use crate::light::{FAR, NEAR};
use crate::looks::Looks;
use crate::renderer::{MAX_SIDE, Picture};
use cast::Facts;
use clench::Model;
use clench::rigid::{Precision, Sim};
use eye::Eye;
use std::iter::repeat_with;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use target::{Target, targets};

/// The maximum number of environments that wait for the threads that draw them.
const MAX_WAITING: usize = 64;
/// The number of pixels that a thread draws at once, which bounds its memory.
const BAND: usize = 1 << 16;
/// The number of pixels that are worth a thread.
const THREAD: usize = 1 << 15;

/// A model whose simulations are drawn by rays.
pub struct RayCaster {
    model: Arc<Model>,
    /// The initial size of the movable geoms, m.
    extent: f32,
}

impl RayCaster {
    /// Measures a model.
    ///
    /// # Errors
    /// Returns an error if the initial state cannot be evaluated.
    pub fn new(model: &Arc<Model>) -> Result<Self, RenderError> {
        let mut sim = Sim::<f64>::new(Arc::clone(model))?;
        Ok(RayCaster {
            extent: FreeCamera::extent(&mut sim)?,
            model: Arc::clone(model),
        })
    }

    /// Checks the size of pictures.
    ///
    /// # Errors
    /// Returns an error if it is out of range.
    pub fn check_size(&self, wanted: &Picture) -> Result<(), RenderError> {
        wanted.check_sides(MAX_SIDE)
    }

    /// Begins the pictures of `count` simulations, which are written into memory by a number of threads. The memory of
    /// colours must be empty.
    ///
    /// # Errors
    /// Returns an error if the size is out of range.
    ///
    /// # Panics
    /// Panics if memory that is not empty has another size than the pictures.
    pub fn pictures<'a>(
        &'a self,
        wanted: &'a Picture,
        count: usize,
        out: Planes<'a>,
        threads: usize,
    ) -> Result<RayPictures<'a>, RenderError> {
        self.check_size(wanted)?;
        wanted.check_memory(count, &out);
        assert!(out.rgb.is_empty(), "rays see no colours");
        // All pictures of a simulation.
        let own = wanted.pixels(1).and_then(NonZeroUsize::new);
        Ok(RayPictures {
            caster: self,
            wanted,
            depth: divided(out.depth, own, count),
            geoms: divided(out.geoms, own, count),
            threads,
            waiting: Vec::new(),
        })
    }
}

/// Divides memory into equal parts, of which none are left if it is empty.
fn divided<S>(memory: &mut [S], part: Option<NonZeroUsize>, count: usize) -> Vec<Option<&mut [S]>> {
    let parts = part.map(|part| memory.chunks_exact_mut(part.get()));
    let parts = parts.into_iter().flatten().map(Some);
    parts.chain(repeat_with(|| None)).take(count).collect()
}

/// Pictures of simulations of one model, which are drawn by several threads.
///
/// Each has the bits of a picture alone.
pub struct RayPictures<'a> {
    caster: &'a RayCaster,
    wanted: &'a Picture,
    /// The memory of each simulation until it is drawn.
    depth: Vec<Option<&'a mut [f32]>>,
    geoms: Vec<Option<&'a mut [i32]>>,
    threads: usize,
    waiting: Vec<Scene<'a>>,
}

/// The geoms of a simulation, its cameras, and the memory of its pictures.
struct Scene<'a> {
    targets: Vec<Target<'a>>,
    eyes: Vec<Eye>,
    depth: &'a mut [f32],
    geoms: &'a mut [i32],
}

impl RayPictures<'_> {
    /// Draws the present state of a simulation, the `index`-th of all, now or with a later one. Of the looks, only the
    /// opacity of geoms matters.
    ///
    /// # Errors
    /// Returns an error if a camera does not exist or the state cannot be evaluated.
    pub fn add<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        index: usize,
        looks: Option<&Looks>,
    ) -> Result<(), RenderError> {
        let (extent, wanted) = (self.caster.extent, self.wanted);
        let eye = |view: &crate::View| {
            let camera = view.pose(sim)?;
            let planes = [NEAR * extent, FAR * extent].map(f64::from);
            Ok(Eye::new(&camera, [wanted.width, wanted.height], planes))
        };
        let eyes = wanted.views.iter().map(eye);
        let eyes = eyes.collect::<Result<_, RenderError>>()?;
        self.waiting.push(Scene {
            eyes,
            targets: targets(&self.caster.model, sim, (&wanted.groups, looks), extent)?,
            depth: (self.depth.get_mut(index).and_then(Option::take)).unwrap_or_default(),
            geoms: (self.geoms.get_mut(index).and_then(Option::take)).unwrap_or_default(),
        });
        if self.waiting.len() == MAX_WAITING {
            self.draw();
        }
        Ok(())
    }

    /// Draws what is left.
    pub fn finish(mut self) {
        self.draw();
    }

    /// Draws the simulations that wait.
    fn draw(&mut self) {
        let pixels = self.wanted.pixels(self.waiting.len()).unwrap_or_default();
        let threads = (pixels / THREAD).min(self.waiting.len()).min(self.threads);
        let scenes = Mutex::new(std::mem::take(&mut self.waiting).into_iter());
        let work = || {
            let mut facts = Facts::default();
            let next = || (scenes.lock().unwrap_or_else(PoisonError::into_inner)).next();
            while let Some(scene) = next() {
                scene.draw(&mut facts);
            }
        };
        std::thread::scope(|scope| {
            (1..threads).for_each(|_| drop(scope.spawn(work)));
            work();
        });
    }
}

impl Scene<'_> {
    /// Writes the pictures of all cameras.
    fn draw(self, facts: &mut Facts) {
        for (k, eye) in self.eyes.iter().enumerate() {
            let [width, height] = eye.size;
            let band = (BAND / width).max(1);
            for row in (0..height).step_by(band) {
                let end = height.min(row + band);
                facts.draw(&self.targets, eye, row..end);
                let pixels = (k * height + row) * width..(k * height + end) * width;
                if let Some(depth) = self.depth.get_mut(pixels.clone()) {
                    (depth.iter_mut().zip(&facts.depth)).for_each(|(to, &from)| *to = from as f32);
                }
                if let Some(geoms) = self.geoms.get_mut(pixels) {
                    (geoms.iter_mut().zip(&facts.geoms)).for_each(|(to, &from)| *to = from as i32);
                }
            }
        }
    }
}
