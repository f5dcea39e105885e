//! Convex hulls, the collision geometry of meshes.
//!
//! [`convex_hull`] computes the surface of the hull of points in exact arithmetic. [`Hull`] is that surface prepared
//! for collision: coplanar triangles are merged to polygons and each vertex has its neighbours.
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

/// The cosine of the tilt (5°) up to which a face is perpendicular to a direction.
pub(crate) const FACE_COSINE: f64 = 0.996;

/// A convex polyhedron about its own origin.
///
/// The numbering of vertices and faces is fixed; counts and orders depend only on the points. Neighbours are those of a
/// triangulation. In it, a vertex that is not furthest along a direction has a neighbour that is further, so climbing
/// from any vertex ends at a furthest one.
#[derive(Clone, PartialEq)]
pub struct Hull {
    vertices: Vec<Vec3<f64>>,
    /// The neighbours of each vertex.
    neighbors: Lists,
    /// The faces that contain each vertex.
    vertex_faces: Lists,
    /// The corners of each face.
    corners: Lists,
    normals: Vec<Vec3<f64>>,
    offsets: Vec<f64>,
    /// The edges between faces; empty if there are many.
    creases: Vec<Crease>,
    center: Vec3<f64>,
    sectors: Sectors,
}

/// The maximum number of faces for which hulls are searched face by face.
pub(crate) const FEW_FACES: usize = 64;

/// An edge between two faces. (Edges within a face are not creases.)
#[derive(Clone, PartialEq)]
pub(crate) struct Crease {
    /// One of its ends, m.
    pub start: Vec3<f64>,
    /// The unit direction to the other end.
    pub along: Vec3<f64>,
    /// The cross product of `start` and `along`, m.
    pub moment: Vec3<f64>,
    /// The face to its left, and the one to its right, seen from outside.
    pub faces: [usize; 2],
    /// The cosine and the sine of the angle between their normals.
    pub rotation: (f64, f64),
}

impl Hull {
    /// Returns the corners, m.
    pub fn vertices(&self) -> &[Vec3<f64>] {
        &self.vertices
    }
    /// Returns an interior point: the mean of the vertices, m.
    pub fn center(&self) -> Vec3<f64> {
        self.center
    }
    /// Returns the vertices that share an edge of the triangulation with a vertex.
    #[inline]
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        self.neighbors.get(vertex)
    }
    /// Returns the faces that contain a vertex: as a corner, or inside up to the tolerance of merging.
    #[inline]
    pub fn faces_at(&self, vertex: usize) -> &[u32] {
        self.vertex_faces.get(vertex)
    }
    /// Returns the number of faces.
    pub fn face_count(&self) -> usize {
        self.normals.len()
    }
    /// Returns the vertices around a face, counter-clockwise seen from outside.
    #[inline]
    pub fn corners(&self, face: usize) -> &[u32] {
        self.corners.get(face)
    }
    /// Returns the face at a vertex that is most nearly perpendicular to the unit vector `direction`; `None` if all
    /// tilt by more than 5°.
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
    /// Returns the edges between faces; none if there are more than [`FEW_FACES`] faces.
    pub(crate) fn creases(&self) -> &[Crease] {
        &self.creases
    }
    /// Returns the outward unit normal of a face.
    pub fn normal(&self, face: usize) -> Vec3<f64> {
        self.normals[face]
    }
    /// Returns the offset of a face's plane along its normal, m. No vertex is beyond it.
    pub fn offset(&self, face: usize) -> f64 {
        self.offsets[face]
    }
    /// Returns the radius of the smallest sphere about the origin that encloses the hull, m.
    pub fn radius(&self) -> f64 {
        let squares = self.vertices.iter().map(|v| v.norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Returns the maximum extent from the origin along x, y and z, to either side, m.
    pub fn extent(&self) -> Vec3<f64> {
        let reach = |axis: usize| {
            let along = self.vertices.iter().map(|v| v[axis].abs());
            along.fold(0.0, f64::max)
        };
        Vec3::new(reach(0), reach(1), reach(2))
    }

    /// Returns the vertex that is furthest along a direction of any length. Among several, the choice depends only on
    /// the direction.
    #[inline]
    pub fn support(&self, direction: Vec3<f64>) -> usize {
        let [x, y, z] = direction.to_array();
        self.furthest_along(x, y, z)
    }

    /// Returns [`support`](Self::support). The direction is passed in registers: a vector in memory is read in other
    /// pieces than those written, which stalls the processor.
    #[inline(never)]
    fn furthest_along(&self, x: f64, y: f64, z: f64) -> usize {
        let direction = Vec3::new(x, y, z);
        let candidates = self.sectors.candidates(direction);
        let (fours, rest) = candidates.as_chunks::<4>();
        // Selections instead of branches, which would be unpredictable.
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

    /// Moves from neighbour to further neighbour.
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
