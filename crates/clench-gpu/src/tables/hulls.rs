//! Convex polyhedra: the hulls of meshes that may collide, once each, and one box for all that may collide with
//! cylinders; and height fields.

use super::{Tables, starts};
use crate::codes::row;
use clench_collide::{HeightField, Hull, ShapeKind, convex_hull};
use clench_math::Vec3;
use clench_rigid::contact::Candidate;
use clench_rigid::model::Model;

row! {
    /// The counts and offsets of a polyhedron, before the furthest vertex of each octant.
    words HullWords, "HULL" {
        vertex_count,
        face_count,
        crease_count,
        vertices,
        planes,
        creases,
        crease_faces,
        neighbors,
        vertex_faces,
        face_corners,
    }
}
row! {
    /// The words of a height field.
    words FieldWords, "FIELD" {
        rows,
        columns,
        /// The offset of its sizes, which its heights follow.
        sizes,
    }
}
row! {
    /// The sizes of a height field, m.
    numbers FieldNumbers, "FIELD_NUMBERS" {
        /// Half its lengths along x and y.
        half: 2,
        /// The lengths of a cell along x and y.
        step: 2,
        elevation: 1,
        base: 1,
        /// The radius of a ball about the origin that contains it.
        radius: 1,
    }
}
/// The start directions of hill climbing to the furthest vertex: one per octant.
const OCTANTS: usize = 8;

/// The maximum number of faces of a hull that is searched face by face, as on the processor.
const FEW_FACES: usize = 64;

/// An edge between two faces: its ends, and the faces that traverse it forward and backward.
struct Crease {
    ends: [usize; 2],
    faces: [usize; 2],
}

impl Crease {
    /// Returns a point of the edge, its direction, and the cosine and sine of the angle between its faces' normals.
    fn numbers(&self, hull: &Hull) -> [f64; 8] {
        let [start, end] = self.ends.map(|v| hull.vertices()[v]);
        let [m, n] = self.faces.map(|face| hull.normal(face));
        let (along, _) = (end - start).normalize();
        let turn = [m.dot(n), m.cross(n).norm()];
        let [a, b] = [start, along].map(Vec3::to_array);
        [a[0], a[1], a[2], b[0], b[1], b[2], turn[0], turn[1]]
    }
}

/// Returns the edges between the faces of a hull; none if it has many faces.
fn creases(hull: &Hull) -> Vec<Crease> {
    if hull.face_count() > FEW_FACES {
        return Vec::new();
    }
    let sides = |face: usize| {
        let corners = hull.corners(face);
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next);
        sides.map(|(&from, &to)| [from as usize, to as usize])
    };
    let all = || (0..hull.face_count()).flat_map(|face| sides(face).map(move |side| (face, side)));
    let forward = all().filter(|(_, [from, to])| from < to);
    let crease = |(face, [from, to]): (usize, [usize; 2])| {
        let (back, _) = all().find(|(_, side)| *side == [to, from])?;
        Some(Crease {
            ends: [from, to],
            faces: [face, back],
        })
    };
    forward.filter_map(crease).collect()
}

impl Tables {
    /// Adds the polyhedra and height fields of a model's pairs, and the one of each geom (`NONE` if it has none).
    /// Returns the maximum number of corners of a face.
    pub(super) fn hulls(&mut self, m: &Model, candidates: &[Candidate]) -> usize {
        self.row::<HullWords>();
        self.row::<FieldWords>();
        self.row::<FieldNumbers>();
        let mut max_corners = 0;
        let mut of_mesh = vec![None; m.meshes.len()];
        let mut of_box = None;
        let mut of_geom = vec![super::NONE as usize; m.geoms.len()];
        for (candidate, &g) in candidates
            .iter()
            .flat_map(|c| c.geoms.iter().map(move |g| (c, g)))
        {
            let g = g as usize;
            let geom = &m.geoms[g];
            let with_cylinder = candidate.kinds == [ShapeKind::Cylinder, ShapeKind::Box];
            if of_geom[g] != super::NONE as usize {
                continue;
            }
            let hull = geom.mesh.and_then(|mesh| m.meshes[mesh].any_hull());
            match (geom.kind, hull) {
                (ShapeKind::Mesh, Some(hull)) => {
                    let offset = geom.mesh.and_then(|mesh| of_mesh[mesh]);
                    let offset = offset.unwrap_or_else(|| self.hull(hull));
                    if let Some(mesh) = geom.mesh {
                        of_mesh[mesh] = Some(offset);
                    }
                    let corners = (0..hull.face_count()).map(|face| hull.corners(face).len());
                    max_corners = corners.fold(max_corners, usize::max);
                    of_geom[g] = offset;
                }
                // A flat box is no polyhedron.
                (ShapeKind::Box, _) if with_cylinder && is_solid(m.params.geom_size[g]) => {
                    of_geom[g] = *of_box.get_or_insert_with(|| self.hull(&unit_box()));
                }
                (ShapeKind::HeightField, _) => {
                    if let Some(field) = m.heights(g) {
                        of_geom[g] = self.height_field(field);
                    }
                }
                _ => {}
            }
        }
        self.words("GEOM_HULL", of_geom);
        max_corners
    }

    /// Adds a polyhedron. Returns its offset.
    fn hull(&mut self, hull: &Hull) -> usize {
        let (vertices, faces) = (0..hull.vertices().len(), 0..hull.face_count());
        let creases = creases(hull);
        let planes = faces.clone().flat_map(|face| {
            let Vec3 { x, y, z } = hull.normal(face);
            [x, y, z, hull.offset(face)]
        });
        let row = HullWords {
            vertex_count: vertices.len(),
            face_count: faces.len(),
            crease_count: creases.len(),
            vertices: self.add_numbers(hull.vertices().iter().flat_map(|v| v.to_array())),
            planes: self.add_numbers(planes),
            creases: self.add_numbers(creases.iter().flat_map(|crease| crease.numbers(hull))),
            crease_faces: self.add_words(creases.iter().flat_map(|crease| crease.faces)),
            neighbors: self.lists(vertices.clone().map(|v| hull.neighbors(v))),
            vertex_faces: self.lists(vertices.map(|v| hull.faces_at(v))),
            face_corners: self.lists(faces.map(|face| hull.corners(face))),
        };
        let furthest = (0..OCTANTS).map(|octant| {
            let sign = |axis: usize| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
            hull.support(Vec3::new(sign(0), sign(1), sign(2)))
        });
        self.add_words(row.words().into_iter().chain(furthest))
    }

    /// Adds a height field. Returns its offset.
    pub(super) fn height_field(&mut self, field: &HeightField) -> usize {
        let [x, y, elevation, base] = field.size();
        let (rows, columns) = (field.rows(), field.columns());
        let step = |half: f64, count: usize| 2.0 * half / (count - 1) as f64;
        let sizes = FieldNumbers {
            half: [x, y],
            step: [step(x, columns), step(y, rows)],
            elevation: [elevation],
            base: [base],
            radius: [field.radius()],
        };
        let heights = field.heights().iter().map(|height| elevation * height);
        let row = FieldWords {
            rows,
            columns,
            sizes: self.add_numbers(sizes.numbers().into_iter().chain(heights)),
        };
        self.add_words(row.words())
    }

    /// Adds lists: the start of each and the end of the last, then all items. Returns their offset.
    fn lists<'a>(&mut self, lists: impl Iterator<Item = &'a [u32]> + Clone) -> usize {
        let begins = starts(lists.clone().map(<[u32]>::len));
        let items = self.words.len() + begins.len();
        let offset = self.add_words(begins.into_iter().map(|begin| items + begin));
        self.add_words(lists.flatten().map(|&item| item as usize));
        offset
    }

    /// Adds words. Returns their offset.
    pub(super) fn add_words(&mut self, values: impl IntoIterator<Item = usize>) -> usize {
        let offset = self.words.len();
        self.words.extend(values.into_iter().map(|v| v as u32));
        offset
    }

    /// Adds numbers. Returns their offset.
    pub(super) fn add_numbers(&mut self, values: impl IntoIterator<Item = f64>) -> usize {
        let offset = self.numbers.len();
        self.numbers.extend(values);
        offset
    }
}

/// Returns true if no half size of a box is zero.
fn is_solid(size: Vec3<f64>) -> bool {
    size.to_array().iter().all(|&x| x > 0.0)
}

/// Returns the box whose half sizes are 1 as a polyhedron; the kernels scale it.
fn unit_box() -> Hull {
    let sign = |k: usize, axis: usize| if k >> axis & 1 == 1 { -1.0 } else { 1.0 };
    let corners = Vec::from_iter((0..8).map(|k| Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2))));
    match convex_hull(&corners, None) {
        Ok(surface) => Hull::new(&surface, &corners),
        Err(error) => unreachable!("a cube has a hull: {error}"),
    }
}
