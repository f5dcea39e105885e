//! A renderer of a model's simulations.

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

/// The maximum number of pixels of a side.
const MAX_SIDE: u32 = 8192;

/// The settings of an image of a simulation.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The view; `None` for a free camera that shows all movable geoms.
    pub view: Option<View>,
    /// The width, pixels.
    pub width: u32,
    /// The height, pixels.
    pub height: u32,
    /// The visible groups of geoms and sites.
    pub groups: Vec<usize>,
    /// True to draw colours.
    pub colors: bool,
    /// True to draw distances and geom indices.
    pub facts: bool,
}

impl Picture {
    /// Creates settings for a colour image of the groups 0 to 2, which MuJoCo also shows.
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

/// The shapes of a model on a GPU.
pub struct Renderer {
    gpu: Gpu,
    passes: Passes,
    model: Arc<Model>,
    corners: Buffer,
    /// The vertices of each geom, of each site, of the ground, and of a tendon segment.
    shapes: Vec<Range<u32>>,
    /// The geoms, the sites, and the ground if the model has none.
    items: Vec<Item>,
    textures: Textures,
    /// The initial size of the movable geoms, m.
    extent: f32,
    shadow: TextureView,
    light: BindGroup,
    canvas: Option<Canvas>,
}

impl Renderer {
    /// Uploads the shapes of a model to a GPU.
    ///
    /// # Errors
    /// Returns an error with a remedy if no device can draw.
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

    /// Returns the name of the device.
    pub fn device(&self) -> &str {
        &self.gpu.name
    }

    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Draws the present state of a simulation of the model.
    ///
    /// # Errors
    /// Returns an error if the size is out of range, the camera does not exist, the state cannot be evaluated, or the
    /// device fails.
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
        let uniforms = Uniforms::new(&camera, aspect, self.extent, centre, &lighting);
        let scene = self.scene_group(&[
            uniforms.as_bytes(),
            items.as_bytes(),
            lighting.lamps.as_bytes(),
        ]);
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

    /// Returns the visible geoms and sites in drawing order.
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
        // Farther items are drawn first, so that nearer ones cover them.
        let distance = |&g: &usize| {
            let place = items[g].pose[3];
            (0..3)
                .map(|k| camera.axes[2][k] * (place[k] - camera.eye[k]))
                .sum::<f32>()
        };
        transparent.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        // The ground is drawn first.
        transparent.splice(..0, groups.len()..self.items.len());
        Shown {
            opaque,
            transparent,
        }
    }

    /// Returns the centre of the movable geoms, around which the sun casts shadows.
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

    /// Creates the bind group of an image: the view, the items and the lights.
    fn scene_group(&self, contents: &[&[u8]; 3]) -> BindGroup {
        let device = &self.gpu.device;
        // An empty buffer cannot be bound.
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

    /// Submits the passes and reads the results.
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

/// The geoms and sites of an image, by their item indices.
struct Shown {
    opaque: Vec<usize>,
    transparent: Vec<usize>,
}

/// The content of an image.
pub struct Draw<'a> {
    pub scene: &'a BindGroup,
    pub opaque: &'a [usize],
    pub transparent: &'a [usize],
    /// The item indices of tendon segments.
    pub strings: Range<usize>,
}
