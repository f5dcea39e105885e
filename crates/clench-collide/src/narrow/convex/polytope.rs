//! A convex polytope about the origin that grows vertex by vertex.
//!
//! Its triangles know the one across each side. A new vertex removes the triangles that see it, which are found by walking
//! from one of them, and closes the rim of the hole with triangles to itself. Triangles keep their signed distance, so an
//! origin that rounding has put outside does no harm.

use super::pair::{Pair, Vertex};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// Room for vertices; a polytope of so many has 2·VERTICES − 4 triangles.
pub(super) const VERTICES: usize = 128;
const FACES: usize = 2 * VERTICES - 4;
/// Vertices nearer than this share of the smaller body are one.
const SAME: f64 = 1e-6;

#[derive(Clone, Copy)]
struct Face<S> {
    /// Counter-clockwise seen from outside.
    corners: [u8; 3],
    /// The faces across the sides; side k leads from corner k to the next.
    across: [u8; 3],
    /// Outward unit vector; zero if the face has no area.
    normal: Vec3<S>,
    /// From the origin, signed; infinite if the face has no area.
    distance: S,
    removed: bool,
}

/// The polytope. Faces are numbered by their place.
pub(super) struct Polytope<S> {
    vertices: ArrayVec<Vertex<S>, VERTICES>,
    faces: ArrayVec<Face<S>, FACES>,
    /// The distance of each face that may still be moved; infinite for others, and where a face was removed.
    distances: ArrayVec<S, FACES>,
    /// Places of removed faces.
    free: ArrayVec<u8, FACES>,
    /// How far beyond a face a vertex must be to count, m.
    rounding: S,
    /// Vertices that are nearer to each other count as one, m: faces between them would be noise.
    same: S,
    /// A point inside.
    middle: Vec3<S>,
}

/// A side of a face that stays, seen from the new vertex at the rim of the faces that go.
type Horizon = ArrayVec<(u8, u8), FACES>;

impl<S: Scalar> Polytope<S> {
    /// A tetrahedron with a volume.
    pub fn new(pair: &Pair<S>, tetrahedron: [Vertex<S>; 4]) -> Self {
        let [a, b, c, d] = tetrahedron;
        let mut polytope = Polytope {
            vertices: ArrayVec::new(),
            faces: ArrayVec::new(),
            distances: ArrayVec::new(),
            free: ArrayVec::new(),
            rounding: pair.largest * S::EPSILON * S::new(4.0),
            same: (pair.smallest * S::new(SAME)).max(pair.tolerance),
            middle: (a.w + b.w + c.w + d.w) * S::new(0.25),
        };
        let volume = (b.w - a.w).cross(c.w - a.w).dot(d.w - a.w);
        let (b, c) = if volume > S::ZERO { (c, b) } else { (b, c) };
        polytope.vertices.extend([a, b, c, d]);
        // Seen against d, the first face turns counter-clockwise now.
        for (corners, across) in [
            ([0, 1, 2], [1, 2, 3]),
            ([1, 0, 3], [0, 3, 2]),
            ([2, 1, 3], [0, 1, 3]),
            ([0, 2, 3], [0, 2, 1]),
        ] {
            polytope.insert(corners, across);
        }
        polytope
    }

    /// Adds a face and gives its place.
    fn insert(&mut self, corners: [u8; 3], across: [u8; 3]) -> u8 {
        let [a, b, c] = corners.map(|k| self.vertices[k as usize].w);
        let normal = (b - a).cross(c - a);
        let area = normal.norm();
        // A face without area, to rounding, may even look inwards.
        let flat = normal.dot(a - self.middle) <= area * self.rounding;
        let (normal, distance) = if flat {
            (Vec3::ZERO, S::INFINITY)
        } else {
            let normal = normal * (S::ONE / area);
            (normal, normal.dot(a))
        };
        let face = Face {
            corners,
            across,
            normal,
            distance,
            removed: false,
        };
        if let Some(place) = self.free.pop() {
            self.faces[place as usize] = face;
            self.distances[place as usize] = distance;
            return place;
        }
        self.faces.push(face);
        self.distances.push(distance);
        (self.faces.len() - 1) as u8
    }

    /// The face nearest to the origin of those that may still be moved.
    pub fn nearest(&self) -> usize {
        let mut nearest = 0;
        for (k, distance) in self.distances.iter().enumerate() {
            if *distance < self.distances[nearest] {
                nearest = k;
            }
        }
        nearest
    }

    /// The outward unit vector of a face.
    pub fn normal(&self, face: usize) -> Vec3<S> {
        self.faces[face].normal
    }
    /// The signed distance of a face from the origin, m; infinite if it cannot be moved.
    pub fn distance(&self, face: usize) -> S {
        self.distances[face]
    }
    /// A face is as far out as it can be.
    pub fn retire(&mut self, face: usize) {
        self.distances[face] = S::INFINITY;
    }
    /// Whether there is no room for another vertex.
    pub fn is_full(&self) -> bool {
        self.vertices.is_full()
    }
    /// The corners of a face.
    pub fn corners(&self, face: usize) -> [Vertex<S>; 3] {
        self.faces[face].corners.map(|k| self.vertices[k as usize])
    }

    /// Adds a vertex that some face may see.
    pub fn add_anywhere(&mut self, vertex: Vertex<S>) {
        let mut best = (self.rounding, None);
        for (k, face) in self.faces.iter().enumerate() {
            let beyond = face.normal.dot(vertex.w) - face.distance;
            if !face.removed && beyond > best.0 {
                best = (beyond, Some(k));
            }
        }
        if let Some(face) = best.1 {
            self.add(face, vertex);
        }
    }

    /// Replaces the faces that see a vertex by faces to it; `seen` is one of them. Nothing happens, and the answer is no,
    /// if the vertex is one of theirs or rounding has spoilt their rim.
    pub fn add(&mut self, seen: usize, vertex: Vertex<S>) -> bool {
        let near = |k: u8| (self.vertices[k as usize].w - vertex.w).norm() <= self.same;
        if self.vertices.is_full() || self.faces[seen].corners.into_iter().any(near) {
            return false;
        }
        let mut horizon = Horizon::new();
        let mut gone = ArrayVec::<u8, FACES>::new();
        self.remove(seen, &mut gone);
        for side in 0..3 {
            let (next, back) = self.neighbor(seen, side);
            self.look(next, back, vertex.w, &mut horizon, &mut gone);
        }
        let closed = horizon.len() >= 3
            && (0..horizon.len()).all(|k| {
                let next = horizon[(k + 1) % horizon.len()];
                self.side(horizon[k]).0 == self.side(next).1
            });
        let room = self.faces.remaining_capacity() + self.free.len() + gone.len();
        if !closed || room < horizon.len() {
            for place in gone {
                self.faces[place as usize].removed = false;
            }
            return false;
        }
        for place in gone {
            self.distances[place as usize] = S::INFINITY;
            self.free.push(place);
        }
        let new = self.vertices.len() as u8;
        self.vertices.push(vertex);
        self.fan(new, &horizon);
        true
    }

    /// New faces from the rim to a vertex, in the order of the rim.
    fn fan(&mut self, vertex: u8, horizon: &Horizon) {
        let mut places = ArrayVec::<u8, FACES>::new();
        for &(face, side) in horizon {
            let (from, to) = self.side((face, side));
            let place = self.insert([to, from, vertex], [face, 0, 0]);
            self.faces[face as usize].across[side as usize] = place;
            places.push(place);
        }
        for k in 0..places.len() {
            let (this, next) = (places[k], places[(k + 1) % places.len()]);
            self.faces[this as usize].across[1] = next;
            self.faces[next as usize].across[2] = this;
        }
    }

    /// The corners that a side leads from and to.
    fn side(&self, (face, side): (u8, u8)) -> (u8, u8) {
        let corners = self.faces[face as usize].corners;
        (corners[side as usize], corners[(side as usize + 1) % 3])
    }

    /// The face across a side, and that side as the face counts it.
    fn neighbor(&self, face: usize, side: usize) -> (usize, usize) {
        let next = self.faces[face].across[side];
        let (from, to) = self.side((face as u8, side as u8));
        let back = (0..3).find(|&k| self.side((next, k)) == (to, from));
        (next as usize, back.unwrap_or(0) as usize)
    }

    fn remove(&mut self, face: usize, gone: &mut ArrayVec<u8, FACES>) {
        self.faces[face].removed = true;
        gone.push(face as u8);
    }

    /// Removes `face`, entered across `side`, and those behind it as far as they see `w`; lists the sides where that
    /// ends.
    fn look(
        &mut self,
        face: usize,
        side: usize,
        w: Vec3<S>,
        horizon: &mut Horizon,
        gone: &mut ArrayVec<u8, FACES>,
    ) {
        if self.faces[face].removed {
            return;
        }
        let Face {
            normal, distance, ..
        } = self.faces[face];
        // One without area goes with its neighbours.
        if distance < S::INFINITY && normal.dot(w) - distance <= self.rounding {
            let _ = horizon.try_push((face as u8, side as u8));
            return;
        }
        self.remove(face, gone);
        for turn in 1..3 {
            let (next, back) = self.neighbor(face, (side + turn) % 3);
            self.look(next, back, w, horizon, gone);
        }
    }
}
