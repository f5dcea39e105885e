//! Two bodies in the frame of the first, and the gap between them along a direction.
//!
//! Along a unit direction n from the first body to the second the gap is g(n) = n·w(n), where w(n) = b(−n) − a(n) is
//! the vector from the point of the first that is furthest along n to that of the second furthest against it. The
//! signed distance of the bodies is the largest gap. Its gradient on the sphere is the part of w across n, its Hessian
//! there −(H_A + H_B + g 1).

use super::body::Body;
use super::polyhedron::Polyhedra;
use crate::narrow::placed::AnyPlaced;
use arrayvec::ArrayVec;
use clench_math::{Mat3, Real, Scalar, Vec3};

/// Two bodies in the frame of the first.
pub(super) struct Pair<'a, S> {
    pub a: Body<'a, S>,
    pub b: Body<'a, S>,
    /// The axes of the second body as columns.
    pub rotation: Mat3<S>,
    /// The error of these axes, rad: that of single precision if poses have it, else zero.
    pub rotation_error: S,
    /// The origin of the second body.
    pub offset: Vec3<S>,
    /// The size of the smaller body, m: the scale of tolerances.
    pub smallest: S,
    /// The maximum magnitude of coordinates, m: the scale of rounding errors.
    pub largest: S,
    /// The required accuracy of the gap, m.
    pub tolerance: S,
    pub curved: bool,
}

/// A point of the difference of the cores, and the two points that it is the difference of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex<S> {
    /// The vector from the first body to the second.
    pub w: Vec3<S>,
    /// The point on the first body, in its frame.
    pub a: Vec3<S>,
    /// The point on the second body, in its frame.
    pub b: Vec3<S>,
    /// The numbers of these points if they are corners of polyhedra.
    pub corners: [u32; 2],
}

/// A direction and the gap between the cores along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap<S> {
    pub normal: Vec3<S>,
    pub gap: S,
    /// True if the gap is a local maximum and the direction exact.
    pub is_exact: bool,
}

impl<S: Scalar> Gap<S> {
    /// Takes the other gap if it is larger; of gaps equal up to the tolerance, an exact one. Returns true if it did.
    pub(super) fn improve(&mut self, other: Gap<S>, tolerance: S) -> bool {
        let handicap = match (self.is_exact, other.is_exact) {
            (true, false) => tolerance,
            (false, true) => -tolerance,
            _ => S::ZERO,
        };
        let better = other.gap > self.gap + handicap;
        if better {
            *self = other;
        }
        better
    }
}

impl<'a, S: Scalar> Pair<'a, S> {
    /// Creates a pair in the frame of the first shape; if that is a sphere, which has no axes of its own, with the axes
    /// of the world.
    pub(super) fn new(a: AnyPlaced<'a, S>, b: AnyPlaced<'a, S>) -> Self {
        let (body_a, body_b) = (Body::new(&a.shape), Body::new(&b.shape));
        let (rotation, offset) = if body_a.is_point() {
            (b.pose.rotation, b.pose.position - a.pose.position)
        } else {
            let rotation = a.pose.rotation.transpose() * b.pose.rotation;
            (rotation, a.pose.local(b.pose.position))
        };
        let (rotation, rotation_error) = orthogonal(rotation);
        Pair {
            rotation_error,
            ..Pair::between(body_a, body_b, rotation, offset)
        }
    }

    /// Creates a pair from two bodies and the axes and origin of the second in the frame of the first.
    pub(super) fn between(
        a: Body<'a, S>,
        b: Body<'a, S>,
        rotation: Mat3<S>,
        offset: Vec3<S>,
    ) -> Self {
        let smallest = Real::min(a.bounding_radius, b.bounding_radius);
        let [x, y, z] = offset.to_array().map(S::abs);
        let largest = a.bounding_radius + b.bounding_radius + x + y + z;
        let rounding = largest * S::EPSILON * S::new(64.0);
        Pair {
            curved: a.is_curved() | b.is_curved(),
            a,
            b,
            rotation,
            rotation_error: S::ZERO,
            offset,
            smallest,
            largest,
            tolerance: Real::max(rounding, smallest * S::new(1e-9)),
        }
    }

    /// Returns both bodies as polyhedra, if they are.
    pub(super) fn polyhedra(&self) -> Option<Polyhedra<'a, S>> {
        Some([self.a.polyhedron()?, self.b.polyhedron()?])
    }

    /// Returns the direction between nearby points of the cores.
    pub(super) fn start(&self) -> Vec3<S> {
        let from = self.a.nearest(|| self.offset).unwrap_or(Vec3::ZERO);
        let beside = || self.rotation.transpose_mul(from - self.offset);
        let to = match self.b.nearest(beside) {
            Some(to) => self.offset + self.rotation * to,
            None => self.offset,
        };
        let (start, apart) = (to - from).normalize();
        if apart > S::ZERO {
            start
        } else {
            self.offset.normalize().0
        }
    }

    /// Returns the vertex w(n) for n of any length.
    #[inline]
    pub(super) fn vertex(&self, normal: Vec3<S>) -> Vertex<S> {
        let local = -self.rotation.transpose_mul(normal);
        let a = self.a.corner_along(normal, normal);
        self.difference(a, self.b.corner_along(local, local))
    }

    /// Returns the vertex, among several vertices w(n), that is furthest against `side`, which is near n.
    #[inline]
    pub(super) fn vertex_against(&self, normal: Vec3<S>, side: Vec3<S>) -> Vertex<S> {
        let local = |v| -self.rotation.transpose_mul(v);
        let b = self.b.corner_along(local(normal), local(side));
        self.difference(self.a.corner_along(normal, side), b)
    }

    #[inline]
    fn difference(&self, (a, of_a): (Vec3<S>, u32), (b, of_b): (Vec3<S>, u32)) -> Vertex<S> {
        let (w, corners) = (self.offset + self.rotation * b - a, [of_a, of_b]);
        Vertex { w, a, b, corners }
    }

    /// Returns the gap g(n).
    #[inline]
    pub(super) fn gap(&self, normal: Vec3<S>) -> Gap<S> {
        Gap {
            normal,
            gap: normal.dot(self.vertex(normal).w),
            is_exact: false,
        }
    }

    /// Returns directions across two creases of the gap, from the first body to the second: normals of flat faces and
    /// those across an edge of each body; none for hulls, which have too many.
    pub(super) fn crossings(&self) -> ArrayVec<Vec3<S>, 15> {
        let (own, other) = (Mat3::IDENTITY, self.rotation);
        let mut found = ArrayVec::new();
        let mut add = |direction: Vec3<S>| {
            let (unit, length) = direction.normalize();
            if length > S::EPSILON.sqrt() {
                let ahead = S::ONE.copysign(unit.dot(self.offset));
                found.push(unit * ahead);
            }
        };
        for &i in self.a.face_axes() {
            add(own.column(i));
        }
        for &j in self.b.face_axes() {
            add(other.column(j));
        }
        for &i in self.a.edge_axes() {
            for &j in self.b.edge_axes() {
                add(own.column(i).cross(other.column(j)));
            }
        }
        found
    }

    /// Computes uᵀ (H_A + H_B) v at a direction, for pairs of vectors u, v across it.
    #[inline]
    pub(super) fn curvature<const N: usize>(
        &self,
        normal: Vec3<S>,
        vectors: [(Vec3<S>, Vec3<S>); N],
    ) -> [S; N] {
        let local = |v| self.rotation.transpose_mul(v);
        let of_a = self.a.curvature(normal);
        let of_b = self.b.curvature(local(normal));
        let mut bends = [S::ZERO; N];
        for (bend, (u, v)) in bends.iter_mut().zip(vectors) {
            *bend = of_a.between(u, v) + of_b.between(local(u), local(v));
        }
        bends
    }
}

/// Returns a rotation that is orthogonal up to rounding, and its error, which is that of the given one. The product of
/// rotations in single precision needs one step of Newton's iteration for the polar factor, R (3 − RᵀR) / 2: normals of
/// faces must turn as their corners do.
fn orthogonal<S: Scalar>(rotation: Mat3<S>) -> (Mat3<S>, S) {
    let excess = |row: Vec3<S>| (row.norm_squared() - S::ONE).abs();
    let [x, y, z] = rotation.rows.map(excess);
    let error = x.max(y).max(z);
    if error <= S::EPSILON * S::new(64.0) {
        return (rotation, S::ZERO);
    }
    let square = rotation.transpose() * rotation;
    let row = |k: usize| Mat3::IDENTITY.rows[k] * S::new(1.5) - square.rows[k] * S::new(0.5);
    (rotation * Mat3::from_rows(row(0), row(1), row(2)), error)
}

/// Returns two unit vectors that form a right-handed frame with the unit vector n as the third (Duff et al. 2017).
#[inline]
pub(super) fn across<S: Scalar>(n: Vec3<S>) -> (Vec3<S>, Vec3<S>) {
    let sign = S::ONE.copysign(n.z);
    let a = -S::ONE / (sign + n.z);
    let b = n.x * n.y * a;
    let e = Vec3::new(S::ONE + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let f = Vec3::new(b, sign + n.y * n.y * a, -n.y);
    (e, f)
}
