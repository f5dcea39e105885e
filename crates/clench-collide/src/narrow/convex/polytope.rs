//! A convex polytope around the origin that grows vertex by vertex.
//!
//! Each triangle stores its neighbours. A new vertex removes the triangles that are visible from it, which are found by
//! traversal from one of them, and the hole is closed by triangles from its border, the horizon, to the new vertex.
//! Triangles store signed distances, so the origin may be outside by rounding.

use super::pair::{Pair, Vertex};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// The vertex capacity; a polytope of this size has 2·VERTICES − 4 triangles.
pub(super) const VERTICES: usize = 128;
const FACES: usize = 2 * VERTICES - 4;
/// The distance below which vertices are merged, relative to the smaller body.
pub(crate) const SAME: f64 = 1e-6;

/// A side of a face: the index of the face and of the side, counted from corner to next corner.
#[derive(Clone, Copy)]
struct HalfEdge {
    face: u8,
    side: u8,
}

/// An edge of the horizon: the side of a remaining face, with its start and end corners.
#[derive(Clone, Copy)]
struct HorizonEdge {
    side: HalfEdge,
    ends: [u8; 2],
}

#[derive(Clone, Copy)]
struct Face<S> {
    /// The corners, counter-clockwise seen from outside.
    corners: [u8; 3],
    removed: bool,
    /// The same edges as sides of the neighbouring faces.
    across: [HalfEdge; 3],
    /// The outward unit vector; zero if the face has no area.
    normal: Vec3<S>,
    /// The signed distance from the origin.
    distance: S,
}

/// The polytope.
pub(super) struct Polytope<S> {
    vertices: ArrayVec<Vertex<S>, VERTICES>,
    faces: ArrayVec<Face<S>, FACES>,
    /// The distance of each face that may still move; infinite for others.
    distances: ArrayVec<S, FACES>,
    /// The faces visible from the new vertex.
    visible: ArrayVec<u8, FACES>,
    /// The horizon, in order: sides of the remaining faces.
    horizon: ArrayVec<HorizonEdge, FACES>,
    /// The minimum distance of a new vertex beyond a face, m.
    rounding: S,
    /// The squared distance up to which vertices are merged, m²: faces between them would be noise.
    same: S,
    /// A point inside the polytope.
    middle: Vec3<S>,
}

impl<S: Scalar> Polytope<S> {
    /// Creates an empty polytope.
    #[inline(always)]
    pub(super) fn empty(pair: &Pair<S>) -> Self {
        let same = (pair.smallest * S::new(SAME)).max(pair.tolerance);
        Polytope {
            vertices: ArrayVec::new_const(),
            faces: ArrayVec::new_const(),
            distances: ArrayVec::new_const(),
            visible: ArrayVec::new_const(),
            horizon: ArrayVec::new_const(),
            rounding: pair.largest * S::EPSILON * S::new(4.0),
            same: same * same,
            middle: Vec3::ZERO,
        }
    }

    /// Starts with a tetrahedron that has a volume.
    pub(super) fn begin(&mut self, [a, b, c, d]: &[Vertex<S>; 4]) {
        self.middle = (a.w + b.w + c.w + d.w) * S::new(0.25);
        let volume = (b.w - a.w).cross(c.w - a.w).dot(d.w - a.w);
        let (b, c) = if volume > S::ZERO { (c, b) } else { (b, c) };
        for vertex in [a, b, c, d] {
            self.vertices.push(*vertex);
        }
        // The first face is now counter-clockwise seen from outside.
        for (number, (corners, across)) in [
            ([0, 1, 2], [(1, 0), (2, 0), (3, 0)]),
            ([1, 0, 3], [(0, 0), (3, 2), (2, 1)]),
            ([2, 1, 3], [(0, 1), (1, 2), (3, 1)]),
            ([0, 2, 3], [(0, 2), (2, 2), (1, 1)]),
        ]
        .into_iter()
        .enumerate()
        {
            let across = across.map(|(face, side)| HalfEdge { face, side });
            self.insert(number, corners, across);
        }
    }

    /// Replaces the face `number`, or appends it.
    #[inline(always)]
    fn insert(&mut self, number: usize, corners: [u8; 3], across: [HalfEdge; 3]) {
        let [a, b, c] = corners.map(|k| self.vertices[k as usize].w);
        let normal = (b - a).cross(c - a);
        let area = normal.norm();
        // A face without area, up to rounding, may even point inwards.
        let flat = normal.dot(a - self.middle) <= area * self.rounding;
        let normal = if flat {
            Vec3::ZERO
        } else {
            normal * (S::ONE / area)
        };
        let distance = normal.dot(a);
        let face = Face {
            corners,
            removed: false,
            across,
            normal,
            distance,
        };
        let movable = if flat { S::INFINITY } else { distance };
        if number < self.faces.len() {
            self.faces[number] = face;
            self.distances[number] = movable;
        } else {
            self.faces.push(face);
            self.distances.push(movable);
        }
    }

    /// Returns the face nearest to the origin of those that may still move, and its distance; infinite if there is
    /// none.
    pub(super) fn nearest(&self) -> (usize, S) {
        let mut nearest = (0, S::INFINITY);
        for (k, &distance) in self.distances.iter().enumerate() {
            if distance < nearest.1 {
                nearest = (k, distance);
            }
        }
        nearest
    }

    /// Returns the outward unit vector of a face.
    pub(super) fn normal(&self, face: usize) -> Vec3<S> {
        self.faces[face].normal
    }
    /// Closes a face: it is part of the boundary of the difference and is not expanded again.
    pub(super) fn close(&mut self, face: usize) {
        self.distances[face] = S::INFINITY;
    }
    /// Returns the corners of both bodies at each vertex.
    pub(super) fn corners_of_vertices(&self) -> impl Iterator<Item = [u32; 2]> {
        self.vertices.iter().map(|vertex| vertex.corners)
    }
    /// Returns the corners of each face.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u8; 3]> {
        self.faces.iter().map(|face| face.corners)
    }
    /// Returns true if the vertex capacity is reached.
    pub(super) fn is_full(&self) -> bool {
        self.vertices.is_full()
    }
    /// Returns the vertex indices of a face's corners; indices stay valid.
    pub(super) fn corners(&self, face: usize) -> [u8; 3] {
        self.faces[face].corners
    }
    /// Returns vertices by index.
    pub(super) fn vertices(&self, numbers: [u8; 3]) -> [Vertex<S>; 3] {
        numbers.map(|k| self.vertices[k as usize])
    }

    /// Replaces the faces that are visible from a vertex by faces to it; `visible` is one of them. Returns false
    /// without changes if the capacity is reached, the vertex is one of theirs, or rounding has broken the horizon.
    pub(super) fn add(&mut self, visible: usize, vertex: &Vertex<S>) -> bool {
        let from = |k: u8| (self.vertices[k as usize].w - vertex.w).norm_squared();
        let corners = self.faces[visible].corners;
        if self.is_full() || corners.into_iter().any(|k| from(k) <= self.same) {
            return false;
        }
        self.visible.clear();
        self.horizon.clear();
        self.remove(visible);
        for side in self.faces[visible].across {
            self.find_horizon(side, vertex.w);
        }
        if !self.horizon_is_closed() {
            for &face in &self.visible {
                self.faces[face as usize].removed = false;
            }
            return false;
        }
        self.vertices.push(*vertex);
        self.stitch();
        true
    }

    fn remove(&mut self, face: usize) {
        self.faces[face].removed = true;
        self.visible.push(face as u8);
    }

    /// Traverses the visible faces across a side. A face that is not visible from `w` remains and its side is added to
    /// the horizon; others are removed and traversed further.
    #[inline(always)]
    fn find_horizon(&mut self, across: HalfEdge, w: Vec3<S>) {
        let face = &self.faces[across.face as usize];
        if face.removed {
            return;
        }
        // A face without area has no normal and is removed with its neighbours.
        let has_area = face.normal != Vec3::ZERO;
        if has_area && face.normal.dot(w) - face.distance <= self.rounding {
            let from = across.side as usize;
            let to = if from == 2 { 0 } else { from + 1 };
            let edge = HorizonEdge {
                side: across,
                ends: [face.corners[from], face.corners[to]],
            };
            // Only a broken polytope lists a side twice; then the horizon is not closed.
            let _ = self.horizon.try_push(edge);
            return;
        }
        self.remove_from(across, &w);
    }

    /// Removes a face, entered across one of its sides, and its neighbours that are visible from `w`. Few are visible,
    /// so only this function is a call; the visibility test is inlined.
    #[inline(never)]
    fn remove_from(&mut self, entered: HalfEdge, w: &Vec3<S>) {
        let across = self.faces[entered.face as usize].across;
        self.remove(entered.face as usize);
        for offset in 1..3 {
            self.find_horizon(across[(entered.side as usize + offset) % 3], *w);
        }
    }

    /// Returns true if the visible faces have a single border: it then has two more sides than there are faces.
    fn horizon_is_closed(&self) -> bool {
        let Some(last) = self.horizon.last() else {
            return false;
        };
        let mut start = last.ends[0];
        self.horizon.len() == self.visible.len() + 2
            && self.horizon.iter().all(|edge| {
                let meets = start == edge.ends[1];
                start = edge.ends[0];
                meets
            })
    }

    /// Adds faces from the horizon to the last vertex, at the indices of the visible faces and two more.
    fn stitch(&mut self) {
        let tip = (self.vertices.len() - 1) as u8;
        let (old, count) = (self.faces.len(), self.horizon.len());
        let number = |visible: &[u8], k: usize| match visible.get(k) {
            Some(&face) => face,
            None => (old + k - visible.len()) as u8,
        };
        let mut before = number(&self.visible, count - 1);
        let mut face = number(&self.visible, 0);
        for k in 0..count {
            let next = if k + 1 < count { k + 1 } else { 0 };
            let after = number(&self.visible, next);
            let HorizonEdge { side, ends } = self.horizon[k];
            // From the end of the horizon's side to its start, on to the tip and back: the next face in the horizon is
            // across the second side, the previous one across the last.
            let [second, last] =
                [(after, 2), (before, 1)].map(|(face, side)| HalfEdge { face, side });
            self.insert(face as usize, [ends[1], ends[0], tip], [side, second, last]);
            self.faces[side.face as usize].across[side.side as usize] = HalfEdge { face, side: 0 };
            (before, face) = (face, after);
        }
    }
}
