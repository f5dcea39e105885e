//! Rays of sensors: their origins, the reported fields, and the geoms that they may hit.

use super::{ENDLESS, NONE, Tables};
use clench_collide::{ShapeKind, TriangleMesh, TriangleNode, allowance};
use clench_math::{Scalar, Vec3};
use clench_rigid::model::{Model, RayField, RaySource, Sensor, SensorTarget};
use std::iter::repeat_n;

/// The words of a sensor with rays.
const RAY_SENSOR_FIELDS: [&str; 8] = [
    "RAY_SOURCE",
    "RAY_ELEMENT",
    "RAY_BODY",
    "RAY_FIRST",
    "RAY_PLACE",
    "RAY_SIZE",
    "RAY_FIELD_START",
    "RAY_FIELD_END",
];
/// The origins of rays.
const SOURCES: [&str; 2] = ["FROM_SITE", "FROM_CAMERA"];
/// The words of a node of the bounding-box tree of a mesh's triangles.
const NODE_FIELDS: [&str; 3] = ["NODE_NEXT", "NODE_FACE", "NODE_FACE_COUNT"];
/// The margin of a node's box, relative to the largest coordinate of the mesh, so that rays in the plane of a side hit
/// it.
const NODE_MARGIN: f64 = 1e-6;

/// Returns the origin of a sensor's rays and the reported fields; `None` if it has no rays.
fn rays_of(sensor: &Sensor) -> Option<(RaySource, &[RayField])> {
    match &sensor.target {
        SensorTarget::Rays { source, fields } => Some((*source, fields)),
        _ => None,
    }
}

/// Returns the number of rays of a source.
fn rays_from(m: &Model, source: RaySource) -> usize {
    match source {
        RaySource::Site(_) => 1,
        RaySource::Camera(c) => m.cameras[c].resolution.iter().product(),
    }
}

/// Returns the number of rays of all sensors.
pub(crate) fn ray_count(m: &Model) -> usize {
    let sources = m.sensors.iter().filter_map(rays_of);
    sources.map(|(source, _)| rays_from(m, source)).sum()
}

/// Returns the geoms that rays may hit.
fn visible(m: &Model) -> impl Iterator<Item = usize> + Clone {
    (0..m.geoms.len()).filter(|&g| m.geoms[g].visible)
}

impl Tables {
    pub(super) fn rays<S: Scalar>(&mut self, m: &Model) {
        for names in [&RAY_SENSOR_FIELDS[..], &SOURCES, &NODE_FIELDS] {
            for (code, name) in names.iter().enumerate() {
                self.constant(name, code);
            }
        }
        for &field in RayField::ALL {
            let name = format!("RAY_{}", field.name().to_uppercase());
            self.constant(&name, field as usize);
        }
        self.constant("RAY_SENSOR_SIZE", RAY_SENSOR_FIELDS.len());
        self.constant("NODE_SIZE", NODE_FIELDS.len());
        let (mut sensors, mut of_ray, mut told, mut cutoffs) = (vec![], vec![], vec![], vec![]);
        let all = m.sensors.iter().filter_map(|s| Some((s, rays_of(s)?)));
        for (index, (sensor, (source, fields))) in all.enumerate() {
            let (source_kind, element, body) = match source {
                RaySource::Site(s) => (0, s, m.sites[s].body),
                RaySource::Camera(c) => (1, c, m.cameras[c].body),
            };
            let size = fields.iter().map(|field| field.size()).sum();
            let (first, place) = (of_ray.len(), sensor.numbers.start);
            let listed = [told.len(), told.len() + fields.len()];
            sensors.extend([source_kind, element, body, first, place, size]);
            sensors.extend(listed);
            told.extend(fields.iter().map(|&field| field as usize));
            of_ray.extend(repeat_n(index, rays_from(m, source)));
            let clips = sensor.cutoff > 0.0;
            cutoffs.push(if clips { sensor.cutoff } else { ENDLESS });
        }
        self.count("NRAY", of_ray.len());
        self.words("RAY_SENSOR", of_ray);
        self.words("RAY_SENSORS", sensors);
        self.words("RAY_FIELD", told);
        self.numbers("RAY_CUTOFF", cutoffs);
        self.count("NRAY_GEOM", visible(m).count());
        self.words("RAY_GEOM", visible(m));
        let has = |kind: ShapeKind| visible(m).any(|g| m.geoms[g].kind == kind);
        self.flag("RAYS_MEET_MESHES", has(ShapeKind::Mesh));
        self.flag("RAYS_MEET_TERRAIN", has(ShapeKind::HeightField));
        // Planes are unbounded.
        let reach = |g: usize| match m.geoms[g].kind {
            ShapeKind::Plane => 0.0,
            _ => m.params.geom_rbound[g] * allowance::<S>().to_f64(),
        };
        self.numbers("RAY_REACH", visible(m).map(reach));
    }

    /// Adds the triangles and height fields that rays may hit, each once, and the one of each visible geom. They follow
    /// all parameters, because environments share them.
    pub(crate) fn ray_shapes(&mut self, m: &Model) {
        let mut of_mesh = vec![None; m.meshes.len()];
        let mut of_field = vec![None; m.height_fields.len()];
        let mut of_geom = Vec::new();
        for g in visible(m).filter(|_| ray_count(m) > 0) {
            let geom = &m.geoms[g];
            let mut place = None;
            if let Some(mesh) = geom.mesh {
                let add = || self.triangles(m.meshes[mesh].triangles());
                place = Some(*of_mesh[mesh].get_or_insert_with(add));
            } else if let Some(field) = geom.height_field {
                let add = || self.height_field(&m.height_fields[field].shape);
                place = Some(*of_field[field].get_or_insert_with(add));
            }
            of_geom.push(place.unwrap_or(NONE as usize));
        }
        self.words("RAY_SHAPE", of_geom);
    }

    /// Adds a mesh: the number of tree nodes, and the offsets of these, their boxes and the triangles' corners. Returns
    /// its offset.
    fn triangles(&mut self, mesh: &TriangleMesh) -> usize {
        let mut nodes = Vec::new();
        if !mesh.faces().is_empty() {
            depth_first(mesh.nodes(), 0, &mut nodes);
        }
        let words = nodes
            .iter()
            .flat_map(|&(next, node)| [next, node.first as usize, node.count as usize]);
        let words = self.add_words(words);
        let coordinates = mesh.vertices().iter().flat_map(|v| v.to_array());
        let margin = NODE_MARGIN * coordinates.fold(0.0, |most: f64, x| most.max(x.abs()));
        let room = Vec3::new(margin, margin, margin);
        let sides = |node: &TriangleNode| [node.low - room, node.high + room];
        let boxes = nodes.iter().flat_map(|(_, node)| sides(node));
        let boxes = self.add_numbers(boxes.flat_map(Vec3::to_array));
        let corners = mesh.faces().as_flattened().iter();
        let corners = corners.flat_map(|&corner| mesh.vertices()[corner as usize].to_array());
        let corners = self.add_numbers(corners);
        self.add_words([nodes.len(), words, boxes, corners])
    }
}

/// Lists the nodes of a subtree in depth-first order, each with the index of the node after its subtree: a ray that
/// misses a box continues there. No tree is deeper than 32.
fn depth_first<'a>(
    tree: &'a [TriangleNode],
    index: usize,
    list: &mut Vec<(usize, &'a TriangleNode)>,
) {
    let (node, own) = (&tree[index], list.len());
    list.push((0, node));
    if node.count == 0 {
        depth_first(tree, node.first as usize, list);
        depth_first(tree, node.first as usize + 1, list);
    }
    list[own].0 = list.len();
}
