//! Collada (`.dae`) files: the triangles of a scene, in metres, with the transforms of the scene's nodes.
//!
//! As in RViz and other ROS programs, `<unit>` scales the mesh and `<up_axis>` does not rotate it: robots are written
//! that way. Materials, lights, cameras and lines are skipped. Geometry deformed by a skeleton is an error.

mod file;
mod geometry;
mod scene;
mod transform;

use super::affine::Transform;
use super::triangles::Triangles;
use crate::document;
use file::{File, at, child};
use roxmltree::{Document, Node};
use scene::Instance;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The maximum number of elements and attributes of a file; large scenes have some ten thousand. Each takes some 300
/// bytes in the parser.
const MAX_MARKS: u64 = 1_000_000;
/// The maximum number of vertices and face corners in a scene, counting each instance of a mesh.
const MAX_SIZE: usize = 20_000_000;

pub(super) fn read(bytes: &[u8]) -> Result<Triangles, String> {
    let text = String::from_utf8_lossy(bytes);
    let marks = document::count_marks(&text).map_err(|excess| excess.to_string())?;
    if marks > MAX_MARKS {
        return Err(format!(
            "more than {MAX_MARKS} elements and attributes in a Collada file"
        ));
    }
    let document =
        Document::parse(&text).map_err(|error| format!("not well-formed XML: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err("not a Collada file".to_owned());
    }
    let file = File::new(&document);
    let (mut found, mut size) = (Triangles::default(), 0);
    let mut read_geometries = HashMap::new();
    let unit = Transform::scaling([unit(root)?; 3]);
    for Instance {
        geometry,
        transform,
    } in scene::instances(&file, root)?
    {
        let groups = match read_geometries.entry(geometry.id()) {
            Entry::Occupied(read) => read.into_mut(),
            Entry::Vacant(unread) => unread.insert(geometry::read(&file, geometry)?),
        };
        for polygons in groups.iter() {
            size += polygons.size();
            if size > MAX_SIZE {
                return Err(format!("more than {MAX_SIZE} vertices and corners"));
            }
            polygons.append(&mut found, &(unit * transform));
        }
    }
    match found.faces.is_empty() {
        true => Err("the Collada file has no triangles in its scene".to_owned()),
        false => Ok(found),
    }
}

/// Returns the length of the file's unit in metres.
fn unit<'a>(root: Node<'a, 'a>) -> Result<f64, String> {
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit"));
    let Some((node, written)) = unit.and_then(|unit| Some((unit, unit.attribute("meter")?))) else {
        return Ok(1.0);
    };
    match written.trim().parse() {
        Ok(meter) if meter > 0.0 && f64::is_finite(meter) => Ok(meter),
        _ => Err(at(node, "meter must be a positive number")),
    }
}
