//! A model on the device: the data that its pictures share.

use crate::camera::{CameraPose, FreeCamera};
use crate::device::{Gpu, RenderError};
use crate::items::{self, Item, Surface};
use crate::passes::Passes;
use crate::shapes::Shapes;
use crate::textures::Textures;
use clench::Model;
use clench::rigid::Sim;
use clench_view::surfaces;
use std::sync::Arc;

/// The shapes, surfaces and textures of a model.
pub(crate) struct Scene {
    pub model: Arc<Model>,
    pub shapes: Shapes,
    /// The geoms, the sites, and the ground if the model has none.
    pub items: Vec<Item>,
    /// The group of each geom and of each site.
    pub groups: Vec<usize>,
    /// The texture of each item.
    pub texture_of: Vec<Option<usize>>,
    pub surface_of: Vec<Surface>,
    pub textures: Textures,
    /// The initial size of the movable geoms, m.
    pub extent: f32,
}

impl Scene {
    /// Uploads a model.
    pub(crate) fn new(gpu: &Gpu, passes: &Passes, model: &Arc<Model>) -> Result<Self, RenderError> {
        let mut sim = Sim::<f64>::new(Arc::clone(model))?;
        let extent = FreeCamera::extent(&mut sim)?;
        let mut items = items::of_model(model);
        let ground = items::add_ground(model, &mut items, extent, items::lowest(&mut sim)?);
        items.extend(ground);
        let visuals = &model.visuals;
        let marks = visuals.geoms.iter().chain(&visuals.sites);
        let mut texture_of = Vec::from_iter(marks.map(|&mark| surfaces::texture(model, mark)));
        texture_of.resize(items.len(), None);
        let both = items.iter().zip(&texture_of);
        let surface_of = both.map(|(item, &texture)| Surface::new(model, item, texture));
        let groups = model.geoms.iter().map(|geom| geom.group);
        let groups = groups.chain(model.sites.iter().map(|site| site.group));
        Ok(Scene {
            shapes: Shapes::new(gpu, model, extent, ground.is_some())?,
            textures: Textures::new(gpu, passes, model),
            groups: groups.map(|group| group as usize).collect(),
            model: Arc::clone(model),
            surface_of: surface_of.collect(),
            items,
            texture_of,
            extent,
        })
    }

    /// Returns the drawing order of transparent items: the ground, and then the farthest first, so that nearer ones
    /// cover them.
    pub(crate) fn sorted(
        &self,
        items: &[Item],
        transparent: &[usize],
        camera: &CameraPose,
    ) -> Vec<usize> {
        let distance = |&k: &usize| {
            let place = items[k].pose[3];
            (0..3)
                .map(|k| camera.axes[2][k] * (place[k] - camera.eye[k]))
                .sum::<f32>()
        };
        let mut order = Vec::from_iter(self.groups.len()..self.items.len());
        let ground = order.len();
        order.extend(transparent);
        order[ground..].sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        order
    }

    /// Returns the centre of the movable geoms, around which the sun casts shadows.
    pub(crate) fn centre(&self, items: &[Item]) -> [f32; 3] {
        let moving = (0..self.model.geoms.len()).filter(|&g| self.model.geoms[g].body > 0);
        let mut count = 0.0;
        let mut sum = [0.0; 3];
        for g in moving {
            count += 1.0;
            (0..3).for_each(|k| sum[k] += items[g].pose[3][k]);
        }
        sum.map(|x| if count > 0.0 { x / count } else { 0.0 })
    }
}
