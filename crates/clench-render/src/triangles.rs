//! Triangles of the shapes of geoms, in the geom frames, wound counterclockwise as seen from outside.

use crate::items::Design;
use clench::Model;
use clench::collide::ShapeKind;
use clench::rigid::model::{Mesh, TextureKind};
use clench_view::surfaces::texture;
use std::f32::consts::PI;

/// The number of segments of a circle over that from the equator to a pole.
const QUARTER: usize = 4;

/// A vertex of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, zerocopy::IntoBytes, zerocopy::Immutable)]
pub(crate) struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// The texture coordinates: x across and y down, or a direction in a cube texture.
    pub texcoord: [f32; 3],
}

impl Vertex {
    /// Creates a vertex without texture coordinates.
    fn new(position: [f32; 3], normal: [f32; 3]) -> Self {
        Vertex {
            position,
            normal,
            texcoord: [0.0; 3],
        }
    }
}

/// Returns the triangles of a geom's design; `far` is the size of an infinite plane, `segments` the number of segments
/// of a circle.
pub(crate) fn of_geom(
    model: &Model,
    design: &Design,
    geom: usize,
    far: f32,
    segments: usize,
) -> Vec<Vertex> {
    let described = &model.geoms[geom];
    let mut shape = match described.kind {
        ShapeKind::Mesh => (described.mesh.and_then(|m| model.meshes.get(m)))
            .map(|found| mesh(found))
            .unwrap_or_default(),
        ShapeKind::HeightField => (described.height_field)
            .and_then(|f| model.height_fields.get(f))
            .map(|field| terrain(&field.shape))
            .unwrap_or_default(),
        _ => primitive(design, far, segments),
    };
    if !has_own_texcoords(model, geom) {
        cover(&mut shape, design);
    }
    shape
}

/// Returns true if a mesh file defines the texture coordinates of a geom.
pub(crate) fn has_own_texcoords(model: &Model, geom: usize) -> bool {
    let texture = texture(model, model.visuals.geoms[geom]);
    let planar = texture.is_some_and(|t| model.visuals.textures[t].kind == TextureKind::Plane);
    let mesh = model.geoms[geom].mesh.and_then(|m| model.meshes.get(m));
    planar && mesh.is_some_and(|mesh| !mesh.texcoords.is_empty())
}

/// Returns the triangles of a plane of size `far`.
pub(crate) fn ground(far: f32) -> Vec<Vertex> {
    plane([0.0; 3], far)
}

/// Returns the triangles of a site's design.
pub(crate) fn of_site(design: &Design, segments: usize) -> Vec<Vertex> {
    let mut shape = primitive(design, 0.0, segments);
    cover(&mut shape, design);
    shape
}

/// Returns the triangles of a shape without an asset; `far` is the size of an infinite plane.
fn primitive(design: &Design, far: f32, segments: usize) -> Vec<Vertex> {
    let size = design.size.map(|x| x as f32);
    match design.kind {
        ShapeKind::Plane => plane(size, far),
        ShapeKind::Sphere => round([size[0]; 3], 0.0, segments),
        ShapeKind::Ellipsoid => round(size, 0.0, segments),
        ShapeKind::Capsule => round([size[0]; 3], size[1], segments),
        ShapeKind::Cylinder => cylinder(size[0], size[1], segments),
        ShapeKind::Box => block(size),
        ShapeKind::Mesh | ShapeKind::HeightField => Vec::new(),
    }
}

/// Sets the texture coordinates of each vertex; see [`clench_view::surfaces::texture_scale`].
fn cover(shape: &mut [Vertex], design: &Design) {
    let Some((kind, scale)) = design.texture else {
        return;
    };
    for vertex in shape {
        let [x, y, z] = [0, 1, 2].map(|k| scale[k] as f32 * vertex.position[k]);
        vertex.texcoord = match kind {
            TextureKind::Plane => [x - 0.5, -y - 0.5, 0.0],
            TextureKind::Cube | TextureKind::Sky => [x, y, z],
        };
    }
}

/// Returns a cylinder along z of radius 1 and half length 1, for tendon segments.
pub(crate) fn string(segments: usize) -> Vec<Vertex> {
    cylinder(1.0, 1.0, segments)
}

/// Appends four vertices, counterclockwise from outside, as two triangles. At a pole one of them has no area.
fn quad(out: &mut Vec<Vertex>, corners: [Vertex; 4]) {
    let [a, b, c, d] = corners;
    for [a, b, c] in [[a, b, c], [a, c, d]] {
        if a.position != b.position && b.position != c.position && c.position != a.position {
            out.extend([a, b, c]);
        }
    }
}

fn flat_quad(out: &mut Vec<Vertex>, places: [[f32; 3]; 4]) {
    let normal = normal_of([places[0], places[1], places[2]]);
    quad(out, places.map(|position| Vertex::new(position, normal)));
}

pub(crate) fn normal_of([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let (u, v) = (
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    );
    unit([
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ])
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
    match length > 0.0 {
        true => v.map(|x| x / length),
        false => [0.0, 0.0, 1.0],
    }
}

fn plane(size: [f32; 3], far: f32) -> Vec<Vertex> {
    let reach = |half: f32| if half > 0.0 { half } else { far };
    let (x, y) = (reach(size[0]), reach(size[1]));
    let mut out = Vec::new();
    flat_quad(
        &mut out,
        [[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]],
    );
    out
}

/// Returns an ellipsoid of these half axes, whose halves are shifted by `half` along z and joined by a cylinder.
fn round(axes: [f32; 3], half: f32, segments: usize) -> Vec<Vertex> {
    let upwards = segments / QUARTER;
    // Latitudes from pole to pole; the equator occurs twice, at both ends of the cylinder. Poles are exact, so that
    // their triangles have equal corners.
    let rows: Vec<(f32, f32)> = (0..=upwards)
        .map(|k| (-half, 0.5 * PI * (k as f32 / upwards as f32 - 1.0)))
        .chain((0..=upwards).map(|k| (half, 0.5 * PI * k as f32 / upwards as f32)))
        .collect();
    let corner = |&(shift, latitude): &(f32, f32), k: usize| {
        let longitude = 2.0 * PI * (k % segments) as f32 / segments as f32;
        let across = match latitude.abs() < 0.499 * PI {
            true => latitude.cos(),
            false => 0.0,
        };
        let on = [
            across * longitude.cos(),
            across * longitude.sin(),
            latitude.sin(),
        ];
        let position = [axes[0] * on[0], axes[1] * on[1], axes[2] * on[2] + shift];
        let normal = unit([on[0] / axes[0], on[1] / axes[1], on[2] / axes[2]]);
        Vertex::new(position, normal)
    };
    let mut out = Vec::new();
    for pair in rows.windows(2) {
        for k in 0..segments {
            let corners = [
                corner(&pair[0], k),
                corner(&pair[0], k + 1),
                corner(&pair[1], k + 1),
                corner(&pair[1], k),
            ];
            quad(&mut out, corners);
        }
    }
    out
}

fn cylinder(radius: f32, half: f32, segments: usize) -> Vec<Vertex> {
    let mut out = Vec::new();
    let on = |k: usize| {
        let angle = 2.0 * PI * (k % segments) as f32 / segments as f32;
        (angle.cos(), angle.sin())
    };
    for k in 0..segments {
        let (a, b) = (on(k), on(k + 1));
        let side =
            |(x, y): (f32, f32), z: f32| Vertex::new([radius * x, radius * y, z], [x, y, 0.0]);
        quad(
            &mut out,
            [side(a, -half), side(b, -half), side(b, half), side(a, half)],
        );
        for (z, [first, second]) in [(half, [a, b]), (-half, [b, a])] {
            let normal = [0.0, 0.0, z.signum()];
            let places = [(0.0, 0.0), first, second];
            let on = |(x, y): (f32, f32)| [radius * x, radius * y, z];
            out.extend(places.map(|at| Vertex::new(on(at), normal)));
        }
    }
    out
}

fn block(half: [f32; 3]) -> Vec<Vertex> {
    let mut out = Vec::new();
    for axis in 0..3 {
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [-1.0, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut position = [0.0; 3];
                position[axis] = side * half[axis];
                position[first] = u * side * half[first];
                position[second] = v * half[second];
                position
            };
            flat_quad(
                &mut out,
                [
                    corner(-1.0, -1.0),
                    corner(1.0, -1.0),
                    corner(1.0, 1.0),
                    corner(-1.0, 1.0),
                ],
            );
        }
    }
    out
}

fn mesh(mesh: &Mesh) -> Vec<Vertex> {
    let position = |&corner: &u32| mesh.vertices[corner as usize].to_array().map(|x| x as f32);
    let triangle = |(index, corners): (usize, &[u32; 3])| {
        let places = corners.each_ref().map(position);
        let normal = normal_of(places);
        let mut triangle = places.map(|position| Vertex::new(position, normal));
        if let Some(corners) = mesh.face_texcoords.get(index) {
            for (vertex, &corner) in triangle.iter_mut().zip(corners) {
                let [across, down] = mesh.texcoords[corner as usize];
                vertex.texcoord = [across, down, 0.0];
            }
        }
        triangle
    };
    mesh.faces.iter().enumerate().flat_map(triangle).collect()
}

/// Returns the surface of a height field with the sides and the bottom of its base.
fn terrain(field: &clench::collide::HeightField) -> Vec<Vertex> {
    let (rows, columns) = (field.rows(), field.columns());
    let [x, y, elevation, base] = field.size().map(|x| x as f32);
    let heights = field.heights();
    let along = |k: usize, count: usize| 2.0 * k as f32 / (count - 1) as f32 - 1.0;
    let at = |row: usize, column: usize| {
        let height = heights[row * columns + column] as f32;
        [
            x * along(column, columns),
            y * along(row, rows),
            elevation * height,
        ]
    };
    let under = |[x, y, _]: [f32; 3]| [x, y, -base];
    let mut out = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let corners = [
                at(row, column),
                at(row, column + 1),
                at(row + 1, column + 1),
                at(row + 1, column),
            ];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                let places = triangle.map(|k| corners[k]);
                let normal = normal_of(places);
                out.extend(places.map(|position| Vertex::new(position, normal)));
            }
        }
    }
    let mut side = |a: [f32; 3], b: [f32; 3]| flat_quad(&mut out, [under(a), under(b), b, a]);
    for column in 0..columns - 1 {
        side(at(0, column), at(0, column + 1));
        side(at(rows - 1, column + 1), at(rows - 1, column));
    }
    for row in 0..rows - 1 {
        side(at(row + 1, 0), at(row, 0));
        side(at(row, columns - 1), at(row + 1, columns - 1));
    }
    let bottom = [
        [-x, y, -base],
        [x, y, -base],
        [x, -y, -base],
        [-x, -y, -base],
    ];
    flat_quad(&mut out, bottom);
    out
}
