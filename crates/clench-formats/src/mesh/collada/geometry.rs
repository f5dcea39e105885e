//! `<geometry>`: vertices and faces of a mesh.

use super::file::{File, at, child, children, numbers};
use crate::mesh::affine::{Transform, to_single};
use crate::mesh::ears::triangulate;
use crate::mesh::triangles::Triangles;
use clench_math::Vec3;
use roxmltree::Node;

/// The maximum numbers per corner: no file has more than a vertex, a normal, a colour and some texture coordinates.
const MAX_INPUTS: usize = 64;

/// Reads all groups of faces of a geometry; none for a spline.
///
/// # Errors
/// Returns an error if faces refer to missing elements or are not supported.
pub(super) fn read<'a>(file: &File<'a>, geometry: Node<'a, 'a>) -> Result<Vec<Polygons>, String> {
    let mut found = Vec::new();
    let groups = child(geometry, "mesh")
        .into_iter()
        .flat_map(|mesh| mesh.children());
    for group in groups.filter(Node::is_element) {
        match group.tag_name().name() {
            "triangles" | "polylist" | "polygons" => found.push(Polygons::read(file, group)?),
            "tristrips" | "trifans" => return Err(at(group, "is not supported")),
            _ => {}
        }
    }
    Ok(found)
}

/// Faces with their own numbering of vertices.
pub(super) struct Polygons {
    positions: Vec<Vec3<f64>>,
    /// The vertices of all faces, one face after the other.
    corners: Vec<usize>,
    /// The number of corners of each face.
    counts: Vec<usize>,
}

impl Polygons {
    fn read<'a>(file: &File<'a>, group: Node<'a, 'a>) -> Result<Self, String> {
        let inputs = || children(group, "input");
        let vertex = inputs().find(|input| input.attribute("semantic") == Some("VERTEX"));
        let vertex = vertex.ok_or_else(|| at(group, "has no input for vertices"))?;
        let mut stride = 1;
        for input in inputs() {
            stride = stride.max(1 + offset(input)?);
        }
        let offset = offset(vertex)?;
        let positions = positions(file, file.source(vertex)?)?;
        let mut lists = Vec::new();
        for list in children(group, "p") {
            let all: Vec<usize> = numbers(list)?;
            let rows = all.chunks_exact(stride);
            if !rows.remainder().is_empty() {
                let message = format!("does not have {stride} numbers for each corner");
                return Err(at(list, &message));
            }
            lists.push(rows.map(|row| row[offset]).collect::<Vec<usize>>());
        }
        let counts: Vec<usize> = match group.tag_name().name() {
            "triangles" => vec![3; lists.iter().map(Vec::len).sum::<usize>() / 3],
            "polygons" => lists.iter().map(Vec::len).collect(),
            _ => child(group, "vcount").map_or(Ok(Vec::new()), numbers)?,
        };
        let corners = lists.concat();
        let sum = (counts.iter()).fold(0_usize, |sum, &count| sum.saturating_add(count));
        if sum != corners.len() {
            let listed = corners.len();
            let message = format!("its faces have {sum} corners, but {listed} are listed");
            return Err(at(group, &message));
        }
        if let Some(bad) = corners.iter().find(|&&corner| corner >= positions.len()) {
            let message = format!("a face refers to vertex {bad}, which does not exist");
            return Err(at(group, &message));
        }
        Ok(Polygons {
            positions,
            corners,
            counts,
        })
    }

    /// Returns the number of vertices and corners.
    pub(super) fn size(&self) -> usize {
        self.positions.len() + self.corners.len()
    }

    /// Adds the triangles, transformed to the scene. Omits vertices that no face uses.
    pub(super) fn append(&self, found: &mut Triangles, transform: &Transform) {
        let mut numbers: Vec<Option<u32>> = vec![None; self.positions.len()];
        let mut rest = &self.corners[..];
        for &count in &self.counts {
            let (face, after) = rest.split_at(count);
            rest = after;
            if face.len() < 3 {
                continue;
            }
            let places: Vec<_> = face.iter().map(|&corner| self.positions[corner]).collect();
            for mut triangle in triangulate(&places) {
                if transform.mirrors() {
                    triangle.reverse();
                }
                let mut number = |corner: usize| {
                    *numbers[face[corner]].get_or_insert_with(|| {
                        found
                            .vertices
                            .push(to_single(transform.point(places[corner])));
                        found.vertices.len() as u32 - 1
                    })
                };
                let triangle = triangle.map(&mut number);
                found.faces.push(triangle);
            }
        }
    }
}

/// Returns the offset of an input in the numbers of a corner.
fn offset(input: Node) -> Result<usize, String> {
    match input.attribute("offset").unwrap_or("0").trim().parse() {
        Ok(offset) if offset < MAX_INPUTS => Ok(offset),
        _ => Err(at(
            input,
            "the offset is not an integer in the supported range",
        )),
    }
}

/// Returns the points of `<vertices>`.
fn positions<'a>(file: &File<'a>, vertices: Node<'a, 'a>) -> Result<Vec<Vec3<f64>>, String> {
    let mut inputs = children(vertices, "input");
    let input = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
    let input = input.ok_or_else(|| at(vertices, "has no input for positions"))?;
    let source = file.source(input)?;
    let array = child(source, "float_array");
    let array = array.ok_or_else(|| at(source, "has no numbers"))?;
    let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
    let setting = |name: &str, default: usize| -> Result<usize, String> {
        let Some((node, written)) = accessor.and_then(|node| Some((node, node.attribute(name)?)))
        else {
            return Ok(default);
        };
        (written.trim().parse())
            .map_err(|_| at(node, &format!("{name} is not a non-negative integer")))
    };
    let (stride, offset) = (setting("stride", 3)?, setting("offset", 0)?);
    if stride < 3 {
        return Err(at(source, "a point has three coordinates"));
    }
    let numbers: Vec<f64> = numbers(array)?;
    let rows = numbers.get(offset..).unwrap_or_default().chunks(stride);
    Ok(rows
        .filter_map(|row| row.first_chunk::<3>())
        .map(|&point| Vec3::from_array(point))
        .collect())
}
