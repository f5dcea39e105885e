//! Draws pictures of a model's simulations.

mod draw;

use crate::camera::{FreeCamera, Placed, View};
use crate::canvas::{Canvas, copy, read, texture};
use crate::device::{Gpu, RenderError};
use crate::image::Image;
use crate::items::{self, Item};
use crate::light::{FAR, Lighting, REACH, SHADOW, Uniforms, light_group};
use crate::passes::{DEPTH, Passes};
use crate::textures::Textures;
use crate::triangles::{self, Vertex};
use clench::Model;
use clench::rigid::readout::light_places;
use clench::rigid::{Precision, Sim};
use std::ops::Range;
use std::sync::Arc;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, Buffer, BufferUsages, MapMode, PollType,
    TextureView,
};
use zerocopy::IntoBytes;

/// The most pixels of a side.
const MAX_SIDE: u32 = 8192;

/// What to draw of a simulation.
#[derive(Clone, Debug)]
pub struct Picture {
    /// From where; by all that moves where none is given.
    pub view: Option<View>,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Which groups of geoms and sites are seen.
    pub groups: Vec<usize>,
    /// Whether colours are wanted.
    pub colors: bool,
    /// Whether distances and geoms are wanted.
    pub facts: bool,
}

impl Picture {
    /// The colours of the groups 0 to 2, which MuJoCo shows too.
    pub fn new(width: u32, height: u32) -> Self {
        Picture {
            view: None,
            width,
            height,
            groups: vec![0, 1, 2],
            colors: true,
            facts: false,
        }
    }
}

/// The shapes of a model on a device that draws.
pub struct Renderer {
    gpu: Gpu,
    passes: Passes,
    model: Arc<Model>,
    corners: Buffer,
    /// The corners of each geom, of each site, of the ground, and of a part of a tendon.
    shapes: Vec<Range<u32>>,
    /// Geoms, sites, and the ground where the model has none.
    items: Vec<Item>,
    textures: Textures,
    /// The size of what moves at first, m.
    extent: f32,
    shadow: TextureView,
    light: BindGroup,
    canvas: Option<Canvas>,
}

impl Renderer {
    /// Brings the shapes of a model to a device.
    ///
    /// # Errors
    /// No device that draws, with what to install.
    pub fn new(model: &Arc<Model>) -> Result<Self, RenderError> {
        let gpu = Gpu::open()?;
        let passes = Passes::new(&gpu.device, !model.visuals.lights.is_empty());
        let mut sim = Sim::<f64>::new(Arc::clone(model))?;
        let extent = (FreeCamera::of_all(&mut sim)?.distance / 1.75) as f32;
        let mut items = items::of_model(model);
        let ground = items::add_ground(model, &mut items, extent, items::lowest(&mut sim)?);
        let wide = ground.map(|_| triangles::ground(FAR * extent));
        items.extend(ground);
        let mut corners: Vec<Vertex> = Vec::new();
        let mut shapes = Vec::new();
        let geoms = (0..model.geoms.len())
            .map(|g| triangles::of_geom(model, &model.params, g, FAR * extent));
        let sites = (0..model.sites.len()).map(|s| triangles::of_site(model, &model.params, s));
        for shape in geoms.chain(sites).chain(wide).chain([triangles::string()]) {
            let start = corners.len() as u32;
            corners.extend(shape);
            shapes.push(start..corners.len() as u32);
        }
        let corners = gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("corners"),
            contents: corners.as_bytes(),
            usage: BufferUsages::VERTEX,
        });
        let shadow = texture(&gpu, [SHADOW; 2], DEPTH, 1);
        let shadow = shadow.create_view(&Default::default());
        let light = light_group(&gpu, &passes, &shadow);
        Ok(Renderer {
            items,
            textures: Textures::new(&gpu, &passes, model),
            model: Arc::clone(model),
            gpu,
            passes,
            corners,
            shapes,
            extent,
            shadow,
            light,
            canvas: None,
        })
    }

    /// The name of the device.
    pub fn device(&self) -> &str {
        &self.gpu.name
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Draws a simulation of the model as it is now.
    ///
    /// # Errors
    /// A size or a camera that is not there; a state that cannot be evaluated; a device that fails.
    pub fn draw<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        wanted: &Picture,
    ) -> Result<Image, RenderError> {
        let most = MAX_SIDE.min(self.gpu.device.limits().max_texture_dimension_2d);
        let [width, height] = [wanted.width, wanted.height];
        if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
            return Err(RenderError::Size(width, height, most));
        }
        let view = match wanted.view {
            Some(view) => view,
            None => View::Free(FreeCamera::of_all(sim)?),
        };
        let camera = view.place(sim)?;
        let mut items = self.items.clone();
        for (item, pose) in items.iter_mut().zip(items::poses(sim)?) {
            item.pose = pose;
        }
        let shown = self.shown(&items, &camera, wanted);
        items.extend(items::of_tendons(sim)?);
        let strings = self.items.len()..items.len();
        let aspect = width as f32 / height as f32;
        let centre = self.centre(&items);
        let places = light_places(&self.model, sim.workspace());
        let lighting = Lighting::new(&self.model.visuals, &places, centre, REACH * self.extent);
        let told = Uniforms::new(&camera, aspect, self.extent, centre, &lighting);
        let scene =
            self.scene_group(&[told.as_bytes(), items.as_bytes(), lighting.lamps.as_bytes()]);
        let size = [width, height];
        if self
            .canvas
            .as_ref()
            .is_none_or(|canvas| canvas.size != size)
        {
            self.canvas = Some(Canvas::new(&self.gpu, size));
        }
        let draw = Draw {
            scene: &scene,
            opaque: &shown.opaque,
            transparent: &shown.transparent,
            strings,
        };
        self.submit(&draw, wanted)
    }

    /// Which geoms and sites are drawn, and in which order.
    fn shown(&self, items: &[Item], camera: &Placed, wanted: &Picture) -> Shown {
        let groups = self.model.geoms.iter().map(|geom| geom.group);
        let groups: Vec<i32> = groups
            .chain(self.model.sites.iter().map(|site| site.group))
            .collect();
        let seen =
            |&k: &usize| wanted.groups.contains(&(groups[k] as usize)) && items[k].color[3] > 0.0;
        let all = (0..groups.len()).filter(seen);
        let (opaque, mut transparent): (Vec<_>, Vec<_>) =
            all.partition(|&g| items[g].color[3] >= 1.0);
        // What is farther is drawn first, so that the nearer lies over it.
        let distance = |&g: &usize| {
            let place = items[g].pose[3];
            (0..3)
                .map(|k| camera.axes[2][k] * (place[k] - camera.eye[k]))
                .sum::<f32>()
        };
        transparent.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        // The ground is below all.
        transparent.splice(..0, groups.len()..self.items.len());
        Shown {
            opaque,
            transparent,
        }
    }

    /// The middle of what moves, around which the sun casts shadows.
    fn centre(&self, items: &[Item]) -> [f32; 3] {
        let moving = (0..self.model.geoms.len()).filter(|&g| self.model.geoms[g].body > 0);
        let mut count = 0.0;
        let mut sum = [0.0; 3];
        for g in moving {
            count += 1.0;
            (0..3).for_each(|k| sum[k] += items[g].pose[3][k]);
        }
        sum.map(|x| if count > 0.0 { x / count } else { 0.0 })
    }

    /// What is told of a picture: the view, the items and the lights.
    fn scene_group(&self, contents: &[&[u8]; 3]) -> BindGroup {
        let device = &self.gpu.device;
        // A buffer without anything in it cannot be bound.
        let nothing = [0; 256];
        let buffer = |(index, contents): (usize, &&[u8])| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("scene"),
                contents: if contents.is_empty() {
                    &nothing
                } else {
                    contents
                },
                usage: match index {
                    0 => BufferUsages::UNIFORM,
                    _ => BufferUsages::STORAGE,
                },
            })
        };
        let buffers: Vec<Buffer> = contents.iter().enumerate().map(buffer).collect();
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, buffer)| BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.create_bind_group(&BindGroupDescriptor {
            label: Some("scene"),
            layout: &self.passes.scene,
            entries: &entries,
        })
    }

    /// Lets the device draw, and reads what it drew.
    fn submit(&self, draw: &Draw, wanted: &Picture) -> Result<Image, RenderError> {
        let Some(canvas) = &self.canvas else {
            return Ok(Image::default());
        };
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut copies = Vec::new();
        if wanted.colors {
            self.shade(&mut encoder, draw);
            self.paint(&mut encoder, draw, canvas);
            copies.push(copy(&self.gpu, &mut encoder, &canvas.picture));
        }
        if wanted.facts {
            self.measure(&mut encoder, draw, canvas);
            copies.push(copy(&self.gpu, &mut encoder, &canvas.geoms));
            copies.push(copy(&self.gpu, &mut encoder, &canvas.distances));
        }
        self.gpu.queue.submit([encoder.finish()]);
        for copy in &copies {
            copy.map_async(MapMode::Read, .., |_| {});
        }
        let failed = |error: &dyn std::fmt::Display| {
            RenderError::Failed(self.gpu.name.clone(), error.to_string())
        };
        (self.gpu.device.poll(PollType::wait_indefinitely())).map_err(|error| failed(&error))?;
        let mut read = copies.iter().map(|copy| read(copy, canvas.size));
        let mut image = Image {
            width: wanted.width as usize,
            height: wanted.height as usize,
            ..Image::default()
        };
        if wanted.colors {
            let pixels = read.next().unwrap_or_default();
            image.rgb = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        }
        if wanted.facts {
            let geoms = read.next().unwrap_or_default();
            let depth = read.next().unwrap_or_default();
            image.geoms = geoms.into_iter().map(i32::from_le_bytes).collect();
            image.depth = depth.into_iter().map(f32::from_le_bytes).collect();
        }
        Ok(image)
    }
}

/// The geoms and sites of a picture, by their numbers among the items.
struct Shown {
    opaque: Vec<usize>,
    transparent: Vec<usize>,
}

/// What is drawn.
pub struct Draw<'a> {
    pub scene: &'a BindGroup,
    pub opaque: &'a [usize],
    pub transparent: &'a [usize],
    /// Parts of tendons, among the items.
    pub strings: Range<usize>,
}
