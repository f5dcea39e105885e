//! Collada (`.dae`): the triangles of a scene, in metres, each where the nodes of the scene put it.
//!
//! As RViz and other programs of ROS have it, `<unit>` scales the mesh and `<up_axis>` does not turn it: robots are written
//! that way. Materials, lights, cameras and lines are passed over. What is deformed by a skeleton is an error.

mod geometry;
mod scene;
mod transform;

use super::affine::Transform;
use super::triangles::Triangles;
use crate::document;
use roxmltree::{Document, Node};
use scene::Instance;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Most elements and attributes of a file; large scenes have some ten thousand. The parser takes some 300 bytes for each.
const MAX_MARKS: u64 = 1_000_000;
/// Most vertices and corners of faces in a scene, in which a mesh may stand many times.
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
    let mut known = HashMap::new();
    let unit = Transform::scaling([unit(root)?; 3]);
    for Instance {
        geometry,
        transform,
    } in scene::instances(&file, root)?
    {
        let groups = match known.entry(geometry.id()) {
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

/// How many metres the file's unit is long.
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

/// A file whose elements are known by their ids.
struct File<'a> {
    ids: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> File<'a> {
    fn new(document: &'a Document) -> Self {
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        File { ids }
    }

    /// The element that the `url` of another refers to.
    fn referred(&self, node: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
        self.by_id(node, "url")
    }

    /// The element that the `source` of an input refers to. Some files use an id again in each mesh: that in the input's own is meant.
    fn source(&self, input: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
        let written = input.attribute("source").unwrap_or_default();
        let mesh = input.ancestors().nth(2);
        let mut beside = mesh.into_iter().flat_map(|mesh| mesh.children());
        let is_meant = |other: &Node| other.attribute("id") == written.strip_prefix('#');
        match beside.find(|other| other.is_element() && is_meant(other)) {
            Some(found) => Ok(found),
            None => self.by_id(input, "source"),
        }
    }

    fn by_id(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Node<'a, 'a>, String> {
        let written = node.attribute(attribute);
        let written = written.ok_or_else(|| at(node, &format!("{attribute} is missing")))?;
        let found = written.strip_prefix('#').and_then(|id| self.ids.get(id));
        (found.copied()).ok_or_else(|| at(node, &format!("the file has no element \"{written}\"")))
    }
}

/// The first child of a name.
fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}

/// All children of a name.
fn children<'a>(node: Node<'a, 'a>, name: &str) -> impl Iterator<Item = Node<'a, 'a>> {
    (node.children()).filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The numbers that an element holds.
fn numbers<T: std::str::FromStr>(node: Node) -> Result<Vec<T>, String> {
    let texts = node.children().filter_map(|child| child.text());
    let words = texts.flat_map(str::split_ascii_whitespace);
    words
        .map(|word| {
            let wrong = |_| at(node, &format!("\"{word}\" is not a valid number"));
            word.parse().map_err(wrong)
        })
        .collect()
}

/// What is wrong with an element, and where it stands.
fn at(node: Node, message: &str) -> String {
    let line = node.document().text_pos_at(node.range().start).row;
    format!("line {line}: <{}>: {message}", node.tag_name().name())
}
