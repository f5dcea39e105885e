//! Rays against the triangles of a mesh, with a tree of boxes.
//!
//! Ray and triangle are sheared so that the ray is the z axis. Then the signs of three areas give the side of each
//! edge the ray passes. They are the same for both triangles at an edge, so no ray passes between them (Woop, Benthin &
//! Wald 2013).

use super::line::{Hit, Line, Ray};
use crate::pose::Pose;
use clench_math::{Real, Vec3, kernel};

/// The maximum number of triangles in a leaf.
const LEAF: usize = 4;
/// The capacity for pending nodes: at most the depth of the tree, which is 32 for 2³² triangles.
const STACK: usize = 64;

/// The triangles of a mesh, including those inside its hull, for rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Vec3<f64>>,
    /// The corners of each triangle, in leaf order.
    faces: Vec<[u32; 3]>,
    /// The tree, root first; the two children of a node are adjacent.
    nodes: Vec<TriangleNode>,
}

/// An error in the triangles of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TriangleMeshError {
    /// A corner is not a vertex.
    #[error("face {0} has a corner beyond the {1} vertices")]
    Corner(usize, usize),
    /// A coordinate is not finite.
    #[error("vertex {0} has a coordinate that is not finite")]
    NotFinite(usize),
    /// Too many faces to index.
    #[error("{0} faces are too many")]
    TooMany(usize),
}

/// A box of the tree over the triangles of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleNode {
    /// The lowest coordinates, m.
    pub low: Vec3<f64>,
    /// The highest coordinates, m.
    pub high: Vec3<f64>,
    /// The first face of a leaf, or the first of two adjacent children.
    pub first: u32,
    /// The number of faces of a leaf; 0 for a node with children.
    pub count: u32,
}

impl TriangleMesh {
    /// Creates a mesh of triangles, each given by three indices of `vertices`, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// Returns an error if a corner does not exist or a coordinate is not finite.
    pub fn new(
        vertices: Vec<Vec3<f64>>,
        mut faces: Vec<[u32; 3]>,
    ) -> Result<Self, TriangleMeshError> {
        let finite = |v: &Vec3<f64>| v.to_array().iter().all(|x| x.is_finite());
        if let Some(bad) = vertices.iter().position(|v| !finite(v)) {
            return Err(TriangleMeshError::NotFinite(bad));
        }
        let count = vertices.len();
        let exists = |face: &[u32; 3]| face.iter().all(|&corner| (corner as usize) < count);
        if let Some(bad) = faces.iter().position(|face| !exists(face)) {
            return Err(TriangleMeshError::Corner(bad, count));
        }
        if faces.len() > u32::MAX as usize / 2 {
            return Err(TriangleMeshError::TooMany(faces.len()));
        }
        let mut nodes = vec![bounds(&vertices, &faces, 0)];
        let mut next = 0;
        while next < nodes.len() {
            split(&vertices, &mut faces, &mut nodes, next);
            next += 1;
        }
        Ok(TriangleMesh {
            vertices,
            faces,
            nodes,
        })
    }

    /// Returns the corners of the triangles, m.
    pub fn vertices(&self) -> &[Vec3<f64>] {
        &self.vertices
    }

    /// Returns the vertex indices of each triangle, in the order of the leaves.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the tree of boxes, root first.
    pub fn nodes(&self) -> &[TriangleNode] {
        &self.nodes
    }

    /// Computes the first hit of a ray on a triangle, from either side. The normal points to the side from which the
    /// corners are counter-clockwise.
    #[kernel]
    pub fn ray<T: Real>(&self, pose: &Pose<T>, ray: &Ray<T>) -> Hit<T> {
        let (line, unit) = Line::of(pose, ray);
        let (distance, normal) = line.in_each_lane(|line| self.cast(line.origin, line.along));
        unit.hit(pose, distance, normal)
    }

    fn cast(&self, origin: Vec3<f64>, along: Vec3<f64>) -> Option<(f64, Vec3<f64>)> {
        let shear = Shear::new(origin, along);
        let mut best = (f64::INFINITY, None);
        let mut stack = arrayvec::ArrayVec::<(f64, u32), STACK>::new();
        let enters = |node| shear.enters(node, best.0);
        stack.extend(self.nodes.first().and_then(enters).map(|at| (at, 0)));
        while let Some((at, node)) = stack.pop() {
            if at > best.0 {
                continue;
            }
            let node = &self.nodes[node as usize];
            let first = node.first as usize;
            if node.count > 0 {
                for face in &self.faces[first..first + node.count as usize] {
                    if let Some(at) = shear.hits(self.corners(face)).filter(|at| *at < best.0) {
                        best = (at, Some(face));
                    }
                }
                continue;
            }
            // Visit the nearer child first.
            let mut children = [first, first + 1].map(|child| {
                let enters = shear.enters(&self.nodes[child], best.0);
                enters.map(|at| (at, child as u32))
            });
            if let [Some(a), Some(b)] = children
                && a.0 < b.0
            {
                children.swap(0, 1);
            }
            stack.extend(children.into_iter().flatten());
        }
        let (at, face) = best;
        let [p, q, r] = self.corners(face?);
        Some((at, (q - p).cross(r - p).normalize().0))
    }

    fn corners(&self, face: &[u32; 3]) -> [Vec3<f64>; 3] {
        face.map(|corner| self.vertices[corner as usize])
    }
}

/// Creates a leaf of `faces`, the first of which is face `first`.
fn bounds(vertices: &[Vec3<f64>], faces: &[[u32; 3]], first: usize) -> TriangleNode {
    let mut node = TriangleNode {
        low: Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: -Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        first: first as u32,
        count: faces.len() as u32,
    };
    for &corner in faces.as_flattened() {
        let v = vertices[corner as usize];
        for axis in 0..3 {
            node.low[axis] = node.low[axis].min(v[axis]);
            node.high[axis] = node.high[axis].max(v[axis]);
        }
    }
    node
}

/// Divides a leaf that is too large in two along its longest side.
fn split(
    vertices: &[Vec3<f64>],
    faces: &mut [[u32; 3]],
    nodes: &mut Vec<TriangleNode>,
    index: usize,
) {
    let node = nodes[index];
    let (first, count) = (node.first as usize, node.count as usize);
    if count <= LEAF {
        return;
    }
    let sides = node.high - node.low;
    let longest = |a: usize, b: usize| if sides[b] > sides[a] { b } else { a };
    let axis = longest(longest(0, 1), 2);
    let middle = |face: &[u32; 3]| {
        let sum = |sum: f64, &corner: &u32| sum + vertices[corner as usize][axis] / 3.0;
        face.iter().fold(0.0, sum)
    };
    let half = count / 2;
    let own = &mut faces[first..first + count];
    own.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
    let children = [
        bounds(vertices, &own[..half], first),
        bounds(vertices, &own[half..], first + half),
    ];
    nodes[index].first = nodes.len() as u32;
    nodes[index].count = 0;
    nodes.extend(children);
}

/// A ray and the shear that maps it to the z axis.
struct Shear {
    origin: Vec3<f64>,
    inverse: Vec3<f64>,
    /// Axes in an order with the ray longest along the last.
    axes: [usize; 3],
    /// The change of x and y along z, and the inverse of the ray's z component.
    slope: [f64; 2],
    scale: f64,
}

impl Shear {
    fn new(origin: Vec3<f64>, along: Vec3<f64>) -> Self {
        let size = along.to_array().map(f64::abs);
        let mut z = 0;
        for axis in 1..3 {
            if size[axis] > size[z] {
                z = axis;
            }
        }
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Shear {
            origin,
            inverse: Vec3::new(1.0 / along.x, 1.0 / along.y, 1.0 / along.z),
            axes: [x, y, z],
            slope: [along[x] / along[z], along[y] / along[z]],
            scale: 1.0 / along[z],
        }
    }

    /// Returns the entry distance into a node's box if it is less than `limit`.
    fn enters(&self, node: &TriangleNode, limit: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, limit);
        for axis in 0..3 {
            let (inverse, origin) = (self.inverse[axis], self.origin[axis]);
            let (low, high) = (node.low[axis] - origin, node.high[axis] - origin);
            let (near, far) = if inverse.is_sign_negative() {
                (high * inverse, low * inverse)
            } else {
                (low * inverse, high * inverse)
            };
            // min and max ignore the NaN of zero times infinity, for a ray within a side of the box.
            enter = enter.max(near);
            leave = leave.min(far * (1.0 + 4.0 * f64::EPSILON));
        }
        (enter <= leave).then_some(enter)
    }

    /// Returns the distance at which the ray hits a triangle.
    fn hits(&self, corners: [Vec3<f64>; 3]) -> Option<f64> {
        let [kx, ky, kz] = self.axes;
        let [p, q, r] = corners.map(|v| {
            let v = v - self.origin;
            [
                v[kx] - self.slope[0] * v[kz],
                v[ky] - self.slope[1] * v[kz],
                v[kz] * self.scale,
            ]
        });
        let area = |a: [f64; 3], b: [f64; 3]| a[0] * b[1] - a[1] * b[0];
        let (u, v, w) = (area(r, q), area(p, r), area(q, p));
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let whole = u + v + w;
        if !inside || whole == 0.0 {
            return None;
        }
        let at = (u * p[2] + v * q[2] + w * r[2]) / whole;
        (at >= 0.0).then_some(at)
    }
}
