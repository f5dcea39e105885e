//! Convex hulls: what collides of a mesh.
//!
//! [`convex_hull`] finds which of some points lie on their hull, in exact arithmetic; [`Hull`] is that surface made ready for
//! collision: triangles in one plane merged to polygons, each vertex with its neighbours.
//!
//! ```
//! use clench_collide::{Hull, convex_hull};
//! use clench_math::Vec3;
//!
//! // The corners of a cube, and its middle.
//! let corner = |i: usize, axis: usize| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
//! let mut points: Vec<_> = (0..8)
//!     .map(|i| Vec3::new(corner(i, 0), corner(i, 1), corner(i, 2)))
//!     .collect();
//! points.push(Vec3::ZERO);
//!
//! let surface = convex_hull(&points, None)?;
//! let hull = Hull::new(&surface, &points);
//! assert_eq!((hull.vertices().len(), hull.face_count()), (8, 6));
//! # Ok::<(), clench_collide::HullError>(())
//! ```

mod error;
mod faces;
mod lists;
mod quickhull;
mod sectors;

mod surface;

pub use error::HullError;
use lists::Lists;
pub use surface::{HullSurface, convex_hull};

use clench_math::Vec3;
use sectors::Sectors;

use std::fmt;

/// A face counts as lying across a direction up to this tilt (5°).
pub(crate) const FACE_COSINE: f64 = 0.996;

/// A convex polyhedron about its own origin.
///
/// Vertices and faces stay numbered as they are; counts and orders depend on the points alone. Neighbours are those of a
/// triangulation, in which a vertex that is no farthest one along a direction has a neighbour that is farther, so climbing
/// from any vertex ends at a farthest one.
#[derive(Clone, PartialEq)]
pub struct Hull {
    vertices: Vec<Vec3<f64>>,
    /// Of each vertex.
    neighbors: Lists,
    /// Faces that each vertex is in.
    vertex_faces: Lists,
    /// Corners of each face.
    corners: Lists,
    normals: Vec<Vec3<f64>>,
    offsets: Vec<f64>,
    /// None where there are many faces.
    creases: Vec<Crease>,
    center: Vec3<f64>,
    sectors: Sectors,
}

/// Hulls of at most this many faces are searched face by face.
pub(crate) const FEW_FACES: usize = 64;

/// An edge between two faces. (Others lie within a face.)
#[derive(Clone, PartialEq)]
pub(crate) struct Crease {
    /// One of its ends, m.
    pub start: Vec3<f64>,
    /// The unit direction to the other.
    pub along: Vec3<f64>,
    /// The cross product of the two, m.
    pub moment: Vec3<f64>,
    /// The face that goes along it, and the one that comes back.
    pub faces: [usize; 2],
    /// The cosine and the sine of the angle between their normals.
    pub turn: (f64, f64),
}

impl Hull {
    /// Corners, m.
    pub fn vertices(&self) -> &[Vec3<f64>] {
        &self.vertices
    }
    /// A point well inside: the mean of the vertices, m.
    pub fn center(&self) -> Vec3<f64> {
        self.center
    }
    /// The vertices that share an edge of the triangulation with a vertex.
    #[inline]
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        self.neighbors.get(vertex)
    }
    /// The faces that a vertex is in: as a corner, or within a face up to the tolerance of merging.
    #[inline]
    pub fn faces_at(&self, vertex: usize) -> &[u32] {
        self.vertex_faces.get(vertex)
    }
    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.normals.len()
    }
    /// The vertices around a face, counter-clockwise seen from outside.
    #[inline]
    pub fn corners(&self, face: usize) -> &[u32] {
        self.corners.get(face)
    }
    /// The face that lies across the unit vector `direction`, of those at a vertex the one that does most nearly; none if all are
    /// tilted by more than 5°.
    #[inline]
    pub(crate) fn face_across(&self, vertex: usize, direction: Vec3<f64>) -> Option<usize> {
        let mut best = (FACE_COSINE, None);
        for &face in self.faces_at(vertex) {
            let cosine = self.normals[face as usize].dot(direction);
            if cosine >= best.0 {
                best = (cosine, Some(face as usize));
            }
        }
        best.1
    }
    /// The edges between faces; none where there are more than [`FEW_FACES`].
    pub(crate) fn creases(&self) -> &[Crease] {
        &self.creases
    }
    /// The unit vector out of a face.
    pub fn normal(&self, face: usize) -> Vec3<f64> {
        self.normals[face]
    }
    /// Where the plane of a face is along its normal, m. No vertex is beyond it.
    pub fn offset(&self, face: usize) -> f64 {
        self.offsets[face]
    }
    /// The radius of the smallest sphere about the origin that holds the hull, m.
    pub fn radius(&self) -> f64 {
        let squares = self.vertices.iter().map(|v| v.norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// How far it reaches from the origin along x, y and z, to either side, m.
    pub fn extent(&self) -> Vec3<f64> {
        let reach = |axis: usize| {
            let along = self.vertices.iter().map(|v| v[axis].abs());
            along.fold(0.0, f64::max)
        };
        Vec3::new(reach(0), reach(1), reach(2))
    }

    /// The vertex that is farthest along a direction of any length; where several are, one that depends on the direction
    /// alone.
    #[inline]
    pub fn support(&self, direction: Vec3<f64>) -> usize {
        let candidates = self.sectors.candidates(direction);
        let (fours, rest) = candidates.as_chunks::<4>();
        // Selections instead of branches, which could not be predicted.
        let farther = |a: (u32, f64), b: (u32, f64)| {
            let is = b.1 > a.1;
            (if is { b.0 } else { a.0 }, if is { b.1 } else { a.1 })
        };
        let at = |v: u32| (v, self.vertices[v as usize].dot(direction));
        let mut farthest = (0, f64::NEG_INFINITY);
        for four in fours {
            let [a, b, c, d] = *four;
            let best = farther(farther(at(a), at(b)), farther(at(c), at(d)));
            farthest = farther(farthest, best);
        }
        match rest {
            [start] => self.climb(direction, *start as usize),
            _ => farthest.0 as usize,
        }
    }

    /// From neighbour to farther neighbour.
    #[inline]
    fn climb(&self, direction: Vec3<f64>, start: usize) -> usize {
        let mut vertex = start;
        let mut reach = self.vertices[vertex].dot(direction);
        loop {
            let before = vertex;
            for &neighbor in self.neighbors(before) {
                let farther = self.vertices[neighbor as usize].dot(direction);
                if farther > reach {
                    (vertex, reach) = (neighbor as usize, farther);
                }
            }
            if vertex == before {
                return vertex;
            }
        }
    }
}

impl fmt::Debug for Hull {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (vertices, faces) = (self.vertices.len(), self.face_count());
        write!(f, "Hull of {vertices} vertices and {faces} faces")
    }
}
