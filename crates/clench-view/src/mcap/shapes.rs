//! Geom shapes as primitives of Foxglove scenes, in the frames of their bodies.

use crate::surfaces;
use clench::Model;
use clench::collide::ShapeKind;
use clench::math::{Quat, Vec3};
use clench::rigid::model::Appearance;
use serde_json::{Map, Value, json};

/// Half the side of an infinite plane, m.
const FAR: f64 = 20.0;
/// The visible groups of geoms, as in MuJoCo.
const SHOWN: std::ops::Range<i32> = 0..3;

/// Encodes a point or a size.
pub(crate) fn point([x, y, z]: [f64; 3]) -> Value {
    json!({"x": x, "y": y, "z": z})
}

/// Encodes a quaternion; the input has w first.
pub(crate) fn quaternion([w, x, y, z]: [f64; 4]) -> Value {
    json!({"x": x, "y": y, "z": z, "w": w})
}

/// Encodes a position and a quaternion.
pub(crate) fn pose(at: [f64; 3], quat: [f64; 4]) -> Value {
    json!({"position": point(at), "orientation": quaternion(quat)})
}

/// Encodes a colour: red, green, blue and opacity.
pub(crate) fn color([r, g, b, a]: [f32; 4]) -> Value {
    json!({"r": r, "g": g, "b": b, "a": a})
}

/// Returns the primitives of a body, in lists by their kind.
pub(crate) fn of_body(model: &Model, body: usize) -> Map<String, Value> {
    let mut things = Map::new();
    let geoms = model.geoms.iter().enumerate();
    for (g, geom) in geoms.filter(|(_, geom)| geom.body == body && SHOWN.contains(&geom.group)) {
        let color = seen_color(model, model.visuals.geoms[g]);
        if color[3] == 0.0 {
            continue;
        }
        for (kind, thing) in of_geom(model, g, geom.kind, color) {
            let list = things.entry(kind).or_insert_with(|| json!([]));
            if let Value::Array(list) = list {
                list.push(thing);
            }
        }
    }
    things
}

/// Returns the colour of an element; a texture contributes its mean colour.
fn seen_color(model: &Model, appearance: Appearance) -> [f32; 4] {
    let visuals = &model.visuals;
    let mut color = visuals.rgba(appearance);
    if let Some(texture) = surfaces::texture(model, appearance) {
        let mean = visuals.textures[texture].mean();
        for (part, share) in color.iter_mut().zip(mean) {
            *part *= share as f32;
        }
    }
    color
}

fn of_geom(model: &Model, g: usize, kind: ShapeKind, rgba: [f32; 4]) -> Vec<(&'static str, Value)> {
    let p = &model.params;
    let (at, quat) = (p.geom_pos[g], p.geom_quat[g]);
    let [x, y, z] = p.geom_size[g].to_array();
    let geom_pose = pose(at.to_array(), quat.to_array());
    let solid =
        |size: [f64; 3]| json!({"pose": geom_pose, "size": point(size), "color": color(rgba)});
    let tube = |radius: f64, half: f64| {
        let size = [2.0 * radius, 2.0 * radius, 2.0 * half];
        json!({"pose": geom_pose, "size": point(size), "bottom_scale": 1.0, "top_scale": 1.0, "color": color(rgba)})
    };
    let triangles = |points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>| {
        let points: Vec<_> = points.into_iter().map(point).collect();
        let indices = faces.as_flattened();
        json!({"pose": geom_pose, "points": points, "color": color(rgba), "colors": [], "indices": indices})
    };
    match kind {
        ShapeKind::Plane => {
            let reach = |half: f64| if half > 0.0 { half } else { FAR };
            let (x, y) = (reach(x), reach(y));
            let corners = vec![[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]];
            vec![("triangles", triangles(corners, vec![[0, 1, 2], [0, 2, 3]]))]
        }
        ShapeKind::Sphere => vec![("spheres", solid([2.0 * x; 3]))],
        ShapeKind::Ellipsoid => vec![("spheres", solid([x, y, z].map(|half| 2.0 * half)))],
        ShapeKind::Box => vec![("cubes", solid([x, y, z].map(|half| 2.0 * half)))],
        ShapeKind::Cylinder => vec![("cylinders", tube(x, y))],
        ShapeKind::Capsule => {
            let cap = |end: f64| {
                let centre = at + Quat::rotate(quat, Vec3::new(0.0, 0.0, end));
                let pose = pose(centre.to_array(), quat.to_array());
                json!({"pose": pose, "size": point([2.0 * x; 3]), "color": color(rgba)})
            };
            vec![
                ("cylinders", tube(x, y)),
                ("spheres", cap(y)),
                ("spheres", cap(-y)),
            ]
        }
        ShapeKind::Mesh => {
            let mesh = model.geoms[g].mesh.and_then(|m| model.meshes.get(m));
            let surface = mesh.map(|mesh| {
                let points = mesh.vertices.iter().map(|v| v.to_array()).collect();
                ("triangles", triangles(points, mesh.faces.clone()))
            });
            surface.into_iter().collect()
        }
        ShapeKind::HeightField => {
            let field = model.geoms[g]
                .height_field
                .and_then(|f| model.height_fields.get(f));
            let surface = field.map(|field| {
                let (points, faces) = terrain(&field.shape);
                ("triangles", triangles(points, faces))
            });
            surface.into_iter().collect()
        }
    }
}

/// Triangulates the upper surface of a height field.
fn terrain(field: &clench::collide::HeightField) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (rows, columns, heights) = (field.rows(), field.columns(), field.heights());
    let [half_x, half_y, elevation, _] = field.size();
    let along =
        |k: usize, count: usize, half: f64| half * (2.0 * k as f64 / (count - 1) as f64 - 1.0);
    let point_at = |k: usize| {
        let (row, column) = (k / columns, k % columns);
        let (x, y) = (along(column, columns, half_x), along(row, rows, half_y));
        [x, y, elevation * heights[k]]
    };
    let mut faces = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let corner = |down: usize, left: usize| ((row - down) * columns + column - left) as u32;
            faces.push([corner(1, 1), corner(1, 0), corner(0, 0)]);
            faces.push([corner(1, 1), corner(0, 0), corner(0, 1)]);
        }
    }
    ((0..rows * columns).map(point_at).collect(), faces)
}
