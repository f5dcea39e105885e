//! The shapes of geoms, sites and tendons on the device, in several levels of detail.

use crate::camera::CameraPose;
use crate::device::{Gpu, RenderError};
use crate::items::{Design, Item};
use crate::light::FAR;
use crate::simplify::{bounds, simplified};
use crate::triangles::{self, Vertex};
use clench::Model;
use clench::collide::ShapeKind;
use std::f32::consts::PI;
use std::ops::Range;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};
use zerocopy::IntoBytes;

/// The number of segments of a circle at each level of detail.
const CIRCLE_SEGMENTS: [usize; 8] = [8, 12, 16, 20, 28, 36, 52, 72];
/// The number of cells of the longest side of a mesh at each level of detail but the last, which is the mesh itself.
const CELLS: [usize; 9] = [4, 6, 8, 12, 16, 24, 32, 48, 64];
/// The deviation of a mesh whose cells are of size 1: its surface moves by much less than a cell.
const CELL_DEVIATION: f32 = 1.0 / 8.0;
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

/// A camera, and the accuracy that its image requires of shapes.
pub(crate) struct Sight<'a> {
    pub camera: &'a CameraPose,
    /// The height of the image, pixels.
    pub height: u32,
    /// The largest deviation from the exact shapes, pixels.
    pub tolerance: f32,
}

/// A shape in several levels of detail.
#[derive(Clone)]
struct Shape {
    /// The vertices and the deviation from the exact shape, m; the coarsest level is the first.
    levels: Vec<(Range<u32>, f32)>,
    /// The radius of a sphere around the origin that contains the shape, m.
    radius: f32,
    /// True if the back sides of triangles are hidden.
    solid: bool,
}

impl Shapes {
    /// Uploads the shapes of a model of a size, m; with a ground if the model has none.
    ///
    /// # Errors
    /// Returns an error if the device has no room for them.
    pub(crate) fn new(
        gpu: &Gpu,
        model: &Model,
        extent: f32,
        ground: bool,
    ) -> Result<Self, RenderError> {
        let far = FAR * extent;
        let mut corners: Vec<Vertex> = Vec::new();
        let mut all: Vec<Shape> = Vec::new();
        let mut designs: Vec<(Design, usize)> = Vec::new();
        let mut share =
            |all: &mut Vec<Shape>, design: Design, of: &mut dyn FnMut(&Design) -> Shape| {
                let same = designs.iter().find(|(other, _)| *other == design);
                all.push(match same {
                    Some(&(_, index)) => all[index].clone(),
                    None => of(&design),
                });
                if same.is_none() {
                    designs.push((design, all.len() - 1));
                }
            };
        for (g, geom) in model.geoms.iter().enumerate() {
            // The mean of texture coordinates of a file can be anywhere in the texture.
            let simple = geom.kind == ShapeKind::Mesh && !triangles::has_own_texcoords(model, g);
            share(&mut all, Design::of_geom(model, g), &mut |design| {
                let of = |segments| triangles::of_geom(model, design, g, far, segments);
                match simple {
                    true => Shape::of_mesh(&mut corners, &of(0)),
                    false => Shape::new(&mut corners, Round::new(design.kind, design.size), of),
                }
            });
        }
        for s in 0..model.sites.len() {
            share(&mut all, Design::of_site(model, s), &mut |design| {
                let of = |segments| triangles::of_site(design, segments);
                Shape::new(&mut corners, Round::new(design.kind, design.size), of)
            });
        }
        if ground {
            let plane = Round::new(ShapeKind::Plane, [0.0; 3]);
            all.push(Shape::new(&mut corners, plane, |_| triangles::ground(far)));
        }
        let string = Round::new(ShapeKind::Cylinder, [1.0; 3]);
        all.push(Shape::new(&mut corners, string, triangles::string));
        let (contents, most) = (corners.as_bytes(), gpu.device.limits().max_buffer_size);
        if contents.len() as u64 > most {
            let reason = format!("shapes of {} bytes exceed its {most}", contents.len());
            return Err(RenderError::Failed(gpu.name.clone(), reason));
        }
        let corners = gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("corners"),
            contents,
            usage: BufferUsages::VERTEX,
        });
        Ok(Shapes { corners, all })
    }

    /// Returns the vertices of a shape with the pose and stretch of an item, as they are drawn for a camera. The back
    /// sides of their triangles are hidden if the second value is true: as in MuJoCo, a camera in a shape looks out.
    pub(crate) fn at(&self, shape: usize, item: &Item, sight: &Sight) -> (Range<u32>, bool) {
        let shape = &self.all[shape];
        let ([x, y, z, _], [a, b, c, apart]) = (item.pose[3], item.stretch);
        let stretch = a.max(b).max(c);
        let radius = shape.radius * stretch + apart.abs();
        let nearest = sight.camera.distance([x, y, z]) - radius;
        let pixels = sight.camera.pixels(nearest, sight.height);
        (shape.level(sight.tolerance / pixels / stretch), shape.solid)
    }

    /// Returns the vertices of tendon segments; their largest radius has `pixels` pixels.
    pub(crate) fn string(&self, pixels: f32, tolerance: f32) -> Range<u32> {
        (self.all.last()).map_or(0..0, |shape| shape.level(tolerance / pixels))
    }
}

/// The properties of a kind of shape that decide how it is drawn.
struct Round {
    /// The largest radius of the circles that segments replace, m.
    radius: f32,
    solid: bool,
}

impl Round {
    fn new(kind: ShapeKind, size: [f64; 3]) -> Self {
        let (radius, solid) = match kind {
            ShapeKind::Sphere | ShapeKind::Capsule | ShapeKind::Cylinder => (size[0], true),
            ShapeKind::Ellipsoid => (size.into_iter().fold(0.0, f64::max), true),
            ShapeKind::Box | ShapeKind::Mesh | ShapeKind::HeightField => (0.0, true),
            ShapeKind::Plane => (0.0, false),
        };
        Round {
            radius: radius as f32,
            solid,
        }
    }
}

impl Shape {
    fn empty(solid: bool) -> Self {
        Shape {
            levels: Vec::new(),
            radius: 0.0,
            solid,
        }
    }

    /// Appends the vertices of a shape; `of` creates them for a number of segments of a circle.
    fn new(corners: &mut Vec<Vertex>, round: Round, of: impl Fn(usize) -> Vec<Vertex>) -> Self {
        let mut shape = Shape::empty(round.solid);
        let levels = match round.radius > 0.0 {
            true => &CIRCLE_SEGMENTS[..],
            false => &CIRCLE_SEGMENTS[..1],
        };
        for &segments in levels {
            let deviation = round.radius * (1.0 - (PI / segments as f32).cos());
            shape.add(corners, &of(segments), deviation);
        }
        shape
    }

    /// Appends the vertices of a mesh.
    fn of_mesh(corners: &mut Vec<Vertex>, mesh: &[Vertex]) -> Self {
        let mut shape = Shape::empty(true);
        let (_, side) = bounds(mesh);
        // A flat or empty mesh has no volume to divide into cells.
        for cells in CELLS.into_iter().filter(|_| side > 0.0) {
            let level = simplified(mesh, cells);
            if 2 * level.len() < mesh.len() {
                shape.add(corners, &level, CELL_DEVIATION * side / cells as f32);
            }
        }
        shape.add(corners, mesh, 0.0);
        shape
    }

    /// Appends the vertices of a level of detail.
    fn add(&mut self, corners: &mut Vec<Vertex>, level: &[Vertex], deviation: f32) {
        for vertex in level {
            let square: f32 = vertex.position.iter().map(|x| x * x).sum();
            self.radius = self.radius.max(square.sqrt());
        }
        let start = corners.len() as u32;
        corners.extend(level);
        self.levels.push((start..corners.len() as u32, deviation));
    }

    /// Returns the coarsest level that deviates by at most `tolerance`, m, or else the finest.
    fn level(&self, tolerance: f32) -> Range<u32> {
        let fine = |(_, deviation): &&(Range<u32>, f32)| *deviation <= tolerance;
        let found = self.levels.iter().find(fine).or(self.levels.last());
        found.map_or(0..0, |(vertices, _)| vertices.clone())
    }
}
