//! The shapes of geoms, sites and tendons on the device, in several levels of detail.

use crate::camera::Placed;
use crate::device::Gpu;
use crate::light::FAR;
use crate::triangles::{self, Vertex};
use clench::Model;
use clench::collide::ShapeKind;
use std::f32::consts::PI;
use std::ops::Range;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};
use zerocopy::IntoBytes;

/// The number of segments of a circle at each level of detail.
const AROUND: [usize; 4] = [12, 20, 36, 72];
/// The largest deviation of colours from the exact shape, pixels.
pub(crate) const COLOR_TOLERANCE: f32 = 1.0 / 8.0;
/// The largest deviation of the shadow map, which is blurred, pixels.
pub(crate) const SHADOW_TOLERANCE: f32 = 1.0 / 2.0;
/// The largest deviation of distances and geom indices from the exact shape, pixels.
pub(crate) const FACT_TOLERANCE: f32 = 1.0 / 32.0;

/// The shapes of a model.
pub(crate) struct Shapes {
    pub corners: Buffer,
    /// Those of each geom, of each site, of the ground if the model has none, and of a tendon segment.
    all: Vec<Shape>,
}

/// A shape in several levels of detail.
struct Shape {
    /// The vertices and the deviation from the exact shape, m; the coarsest level is the first.
    levels: Vec<(Range<u32>, f32)>,
    /// The radius of a sphere around the origin that contains the shape, m.
    bound: f32,
}

impl Shapes {
    /// Uploads the shapes of a model of a size, m; with a ground if the model has none.
    pub(crate) fn new(gpu: &Gpu, model: &Model, extent: f32, ground: bool) -> Self {
        let far = FAR * extent;
        let mut corners: Vec<Vertex> = Vec::new();
        let mut all = Vec::new();
        let params = &model.params;
        for (g, geom) in model.geoms.iter().enumerate() {
            let radius = curvature(geom.kind, params.geom_size[g].to_array());
            let of = |around| triangles::of_geom(model, params, g, far, around);
            all.push(Shape::new(&mut corners, radius, of));
        }
        for (s, site) in model.sites.iter().enumerate() {
            let radius = curvature(site.kind, params.site_size[s].to_array());
            let of = |around| triangles::of_site(model, params, s, around);
            all.push(Shape::new(&mut corners, radius, of));
        }
        if ground {
            all.push(Shape::new(&mut corners, 0.0, |_| triangles::ground(far)));
        }
        all.push(Shape::new(&mut corners, 1.0, triangles::string));
        let corners = gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("corners"),
            contents: corners.as_bytes(),
            usage: BufferUsages::VERTEX,
        });
        Shapes { corners, all }
    }

    /// Returns the vertices of a shape at a place, for an image of a height that may deviate by `tolerance` pixels.
    pub(crate) fn at(
        &self,
        shape: usize,
        place: [f32; 3],
        (camera, height): (&Placed, u32),
        tolerance: f32,
    ) -> Range<u32> {
        let shape = &self.all[shape];
        let pixels = camera.pixels(place, shape.bound, height);
        shape.level(tolerance / pixels)
    }

    /// Returns the vertices of tendon segments whose largest radius is so many pixels.
    pub(crate) fn string(&self, pixels: f32, tolerance: f32) -> Range<u32> {
        (self.all.last()).map_or(0..0, |shape| shape.level(tolerance / pixels))
    }
}

/// Returns the largest radius of the circles that segments replace, m.
fn curvature(kind: ShapeKind, size: [f64; 3]) -> f32 {
    match kind {
        ShapeKind::Sphere | ShapeKind::Capsule | ShapeKind::Cylinder => size[0] as f32,
        ShapeKind::Ellipsoid => size.into_iter().fold(0.0, f64::max) as f32,
        ShapeKind::Plane | ShapeKind::Box | ShapeKind::Mesh | ShapeKind::HeightField => 0.0,
    }
}

impl Shape {
    /// Appends the vertices of a shape with circles of a radius, which is 0 without.
    fn new(corners: &mut Vec<Vertex>, radius: f32, of: impl Fn(usize) -> Vec<Vertex>) -> Self {
        let mut bound = 0.0f32;
        let mut level = |around: usize| {
            let start = corners.len() as u32;
            let shape = of(around);
            let squares = (shape.iter()).map(|vertex| vertex.place.iter().map(|x| x * x).sum());
            bound = squares.fold(bound, |bound, square: f32| bound.max(square.sqrt()));
            corners.extend(shape);
            let deviation = radius * (1.0 - (PI / around as f32).cos());
            (start..corners.len() as u32, deviation)
        };
        let levels = match radius > 0.0 {
            true => AROUND.into_iter().map(&mut level).collect(),
            false => vec![level(AROUND[0])],
        };
        Shape { levels, bound }
    }

    /// Returns the coarsest level that deviates by at most `tolerance`, m, or else the finest.
    fn level(&self, tolerance: f32) -> Range<u32> {
        let fine = |(_, deviation): &&(Range<u32>, f32)| *deviation <= tolerance;
        let found = self.levels.iter().find(fine).or(self.levels.last());
        found.map_or(0..0, |(vertices, _)| vertices.clone())
    }
}
