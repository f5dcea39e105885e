//! A convex polytope about the origin that grows vertex by vertex.
//!
//! Its triangles know what lies across each side. A new vertex removes the triangles that are visible from it, which are found by walking
//! from one of them, and the hole is closed by triangles from its border, the horizon, to the new vertex. Triangles keep their signed
//! distance, so an origin that rounding has put outside does no harm.

use super::pair::{Pair, Vertex};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// Room for vertices; a polytope of this many has 2·VERTICES − 4 triangles.
pub(super) const VERTICES: usize = 128;
const FACES: usize = 2 * VERTICES - 4;
/// Vertices nearer than this share of the smaller body are one.
const SAME: f64 = 1e-6;

/// A side of a face: the face's number and which of its sides, counted from corner to next corner.
#[derive(Clone, Copy)]
struct HalfEdge {
    face: u8,
    side: u8,
}

/// An edge of the horizon: the side of a face that stays, with the corners that it goes from and to.
#[derive(Clone, Copy)]
struct HorizonEdge {
    side: HalfEdge,
    ends: [u8; 2],
}

#[derive(Clone, Copy)]
struct Face<S> {
    /// Counter-clockwise as seen from outside.
    corners: [u8; 3],
    removed: bool,
    /// The same edges as sides of the faces across.
    across: [HalfEdge; 3],
    /// Outward unit vector; zero if the face has no area.
    normal: Vec3<S>,
    /// From the origin, signed.
    distance: S,
}

/// The polytope.
pub(super) struct Polytope<S> {
    vertices: ArrayVec<Vertex<S>, VERTICES>,
    faces: ArrayVec<Face<S>, FACES>,
    /// The distance of each face that may still be moved; infinite for others.
    distances: ArrayVec<S, FACES>,
    /// Faces visible from the vertex to be added.
    visible: ArrayVec<u8, FACES>,
    /// The horizon, in order: sides of the faces that stay.
    horizon: ArrayVec<HorizonEdge, FACES>,
    /// How far beyond a face a vertex must be to count, m.
    rounding: S,
    /// The square of the distance up to which vertices count as one, m²: faces between them would be noise.
    same: S,
    /// A point inside.
    middle: Vec3<S>,
}

impl<S: Scalar> Polytope<S> {
    /// Nothing yet.
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

    /// Begins with a tetrahedron that has a volume.
    pub(super) fn begin(&mut self, [a, b, c, d]: &[Vertex<S>; 4]) {
        self.middle = (a.w + b.w + c.w + d.w) * S::new(0.25);
        let volume = (b.w - a.w).cross(c.w - a.w).dot(d.w - a.w);
        let (b, c) = if volume > S::ZERO { (c, b) } else { (b, c) };
        for vertex in [a, b, c, d] {
            self.vertices.push(*vertex);
        }
        // Seen against d, the first face turns counter-clockwise now.
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

    /// Puts a face in the place of that with a number, or after the last.
    #[inline(always)]
    fn insert(&mut self, number: usize, corners: [u8; 3], across: [HalfEdge; 3]) {
        let [a, b, c] = corners.map(|k| self.vertices[k as usize].w);
        let normal = (b - a).cross(c - a);
        let area = normal.norm();
        // A face without area, to rounding, may even look inwards.
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

    /// The face nearest to the origin of those that may still be moved, and its distance, infinite if there is none.
    pub(super) fn nearest(&self) -> (usize, S) {
        let mut nearest = (0, S::INFINITY);
        for (k, &distance) in self.distances.iter().enumerate() {
            if distance < nearest.1 {
                nearest = (k, distance);
            }
        }
        nearest
    }

    /// The outward unit vector of a face.
    pub(super) fn normal(&self, face: usize) -> Vec3<S> {
        self.faces[face].normal
    }
    /// Closes a face: it is part of the boundary of the difference and is not expanded again.
    pub(super) fn close(&mut self, face: usize) {
        self.distances[face] = S::INFINITY;
    }
    /// Whether there is no room for another vertex.
    pub(super) fn is_full(&self) -> bool {
        self.vertices.is_full()
    }
    /// The corners of a face, as numbers of vertices, which stay.
    pub(super) fn corners(&self, face: usize) -> [u8; 3] {
        self.faces[face].corners
    }
    /// Vertices by their numbers.
    pub(super) fn vertices(&self, numbers: [u8; 3]) -> [Vertex<S>; 3] {
        numbers.map(|k| self.vertices[k as usize])
    }

    /// Replaces the faces that are visible from a vertex by faces to it; `visible` is one of them. Nothing happens, and the answer is no,
    /// if the vertex is one of theirs or rounding has broken the horizon.
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

    /// Follows the visible faces across a side: a face that is not visible from `w` stays, and its side is part of the horizon; others are
    /// removed, and followed further.
    #[inline(always)]
    fn find_horizon(&mut self, across: HalfEdge, w: Vec3<S>) {
        let face = &self.faces[across.face as usize];
        if face.removed {
            return;
        }
        // One without area has no normal and goes with its neighbours.
        let has_area = face.normal != Vec3::ZERO;
        if has_area && face.normal.dot(w) - face.distance <= self.rounding {
            let from = across.side as usize;
            let to = if from == 2 { 0 } else { from + 1 };
            let edge = HorizonEdge {
                side: across,
                ends: [face.corners[from], face.corners[to]],
            };
            // A side is listed once, unless the polytope is broken, and then the horizon is not closed.
            let _ = self.horizon.try_push(edge);
            return;
        }
        self.remove_from(across, &w);
    }

    /// Removes a face, entered across one of its sides, and its neighbours as far as they are visible from `w`. Few are: so the test of
    /// each is inlined into its callers, and only this is a call.
    #[inline(never)]
    fn remove_from(&mut self, entered: HalfEdge, w: &Vec3<S>) {
        let across = self.faces[entered.face as usize].across;
        self.remove(entered.face as usize);
        for turn in 1..3 {
            self.find_horizon(across[(entered.side as usize + turn) % 3], *w);
        }
    }

    /// Whether the visible faces are a patch with one border: then it has two sides more than they are.
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

    /// Stitches new faces from the horizon to the vertex added last, in the places of the visible faces and two more.
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
            // From the end of the horizon's side to its start, on to the tip and back: the next face in the horizon is across the
            // second side, the one before across the last.
            let [second, last] =
                [(after, 2), (before, 1)].map(|(face, side)| HalfEdge { face, side });
            self.insert(face as usize, [ends[1], ends[0], tip], [side, second, last]);
            self.faces[side.face as usize].across[side.side as usize] = HalfEdge { face, side: 0 };
            (before, face) = (face, after);
        }
    }
}
