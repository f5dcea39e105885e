//! Rays of sensors: their origins, the reported fields, and the geoms that they may hit.

use super::{ENDLESS, NONE, Tables};
use crate::codes::{Code, codes, row};
use clench_collide::{ShapeKind, TriangleMesh, TriangleNode, allowance};
use clench_math::{Scalar, Vec3};
use clench_rigid::model::{Model, RayField, RaySource, Sensor, SensorTarget};
use std::iter::repeat_n;

row! {
    /// The words of a sensor with rays.
    words RayWords, "RAY" {
        source,
        element,
        body,
        /// Its first ray.
        first,
        /// The offset of its numbers in `sensordata`.
        offset,
        /// The numbers of each ray.
        width,
        field_start,
        field_end,
    }
}
codes! {
    /// The origins of rays.
    enum Source {
        Site = "FROM_SITE",
        Camera = "FROM_CAMERA",
    }
}
row! {
    /// The words of a mesh.
    words MeshWords, "MESH" {
        /// The number of nodes of its tree.
        count,
        /// The offsets of these, of their boxes, and of the corners of its triangles.
        nodes,
        boxes,
        corners,
    }
}
row! {
    /// The words of a node of the bounding-box tree of a mesh's triangles.
    words NodeWords, "NODE" {
        next,
        face,
        face_count,
    }
}
/// The margin of a node's box, relative to the largest coordinate of the mesh, so that rays in the plane of a side hit
/// it.
const NODE_MARGIN: f64 = 1e-6;

/// Returns the origin of a sensor's rays and the reported fields; `None` if it has no rays.
fn rays_of(sensor: &Sensor) -> Option<(RaySource, &[RayField])> {
    match &sensor.target {
        SensorTarget::Rays { source, fields } => Some((*source, fields)),
        SensorTarget::Nothing
        | SensorTarget::Element(_)
        | SensorTarget::Frame { .. }
        | SensorTarget::Inside { .. }
        | SensorTarget::Projection { .. }
        | SensorTarget::Geoms(_)
        | SensorTarget::Contacts(_)
        | SensorTarget::Taxels { .. } => None,
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
        self.row::<RayWords>();
        self.codes::<Source>();
        self.row::<MeshWords>();
        self.row::<NodeWords>();
        for &field in RayField::ALL {
            let name = format!("RAY_{}", field.name().to_uppercase());
            self.constant(&name, field as usize);
        }
        let (mut sensors, mut of_ray, mut told, mut cutoffs) = (vec![], vec![], vec![], vec![]);
        let all = m.sensors.iter().filter_map(|s| Some((s, rays_of(s)?)));
        for (index, (sensor, (source, fields))) in all.enumerate() {
            let (source_kind, element, body) = match source {
                RaySource::Site(s) => (Source::Site, s, m.sites[s].body),
                RaySource::Camera(c) => (Source::Camera, c, m.cameras[c].body),
            };
            let row = RayWords {
                source: source_kind.code(),
                element,
                body,
                first: of_ray.len(),
                offset: sensor.numbers.start,
                width: fields.iter().map(|field| field.size()).sum(),
                field_start: told.len(),
                field_end: told.len() + fields.len(),
            };
            sensors.extend(row.words());
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
            ShapeKind::HeightField
            | ShapeKind::Sphere
            | ShapeKind::Capsule
            | ShapeKind::Ellipsoid
            | ShapeKind::Cylinder
            | ShapeKind::Box
            | ShapeKind::Mesh => m.params.geom_rbound[g] * allowance::<S>().to_f64(),
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
            let mut offset = None;
            if let Some(mesh) = geom.mesh {
                let add = || self.triangles(m.meshes[mesh].triangles());
                offset = Some(*of_mesh[mesh].get_or_insert_with(add));
            } else if let Some(field) = geom.height_field {
                let add = || self.height_field(&m.height_fields[field].shape);
                offset = Some(*of_field[field].get_or_insert_with(add));
            }
            of_geom.push(offset.unwrap_or(NONE as usize));
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
        let words = |&(next, node): &(usize, &TriangleNode)| {
            let row = NodeWords {
                next,
                face: node.first as usize,
                face_count: node.count as usize,
            };
            row.words()
        };
        let words = self.add_words(nodes.iter().flat_map(words));
        let coordinates = mesh.vertices().iter().flat_map(|v| v.to_array());
        let margin = NODE_MARGIN * coordinates.fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let padding = Vec3::new(margin, margin, margin);
        let sides = |node: &TriangleNode| [node.low - padding, node.high + padding];
        let boxes = nodes.iter().flat_map(|(_, node)| sides(node));
        let boxes = self.add_numbers(boxes.flat_map(Vec3::to_array));
        let corners = mesh.faces().as_flattened().iter();
        let corners = corners.flat_map(|&corner| mesh.vertices()[corner as usize].to_array());
        let corners = self.add_numbers(corners);
        let row = MeshWords {
            count: nodes.len(),
            nodes: words,
            boxes,
            corners,
        };
        self.add_words(row.words())
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
