//! The largest gap of an overlapping cylinder and polyhedron with few faces, among a few candidate directions.
//!
//! If two bodies overlap, the penetration depth is attained at a smooth point of the boundary of their difference,
//! which has exactly one normal n. For a cylinder with axis z and a polyhedron the candidates are
//!
//! ```text
//! m, z         a normal of a face; of a cap            z × b       an edge b across the side of the cylinder
//! n across z   a corner on the side                    n across b  an edge b on the cap circle
//! ```
//!
//! A corner on the side is relevant only if the whole polyhedron is beside the axis, and then it is the corner nearest
//! to it. Seen along b the cap circle is an ellipse, the edge a point, and n the normal of the ellipse through that
//! point.
//!
//! An edge touches along the directions between the normals of its faces. Let g be the gap through the edge on the path
//! from one of them, m, to the direction n of the largest g at the angle θ. A support function plus its second
//! derivative is not negative, so g″ ≤ −g, and g(n) ≤ g(m) cos θ + g′(m) sin θ. This bounds g′(m) from below, most
//! weakly at the other normal. g′(m) is the distance beyond the edge, in the face's plane, at which the cylinder
//! touches along m. So most edges need not be searched.
//!
//! If the bodies are apart, some of these directions prove it, but the largest gap may be along another.

use super::{
    ellipse::Ellipse,
    largest_gap::LargestGap,
    pair::{Gap, Pair},
    prism::{EDGES, FACES, Prism},
};
use crate::hull::{FEW_FACES, Hull};
use crate::shape::{Cuboid, Cylinder};
use arrayvec::ArrayVec;
use clench_math::{Mat3, Scalar, Vec3};

/// Returns the largest gap of a prism and a cylinder if it is not positive, else any positive one.
pub(super) fn prism_gap<S: Scalar>(
    pair: &Pair<S>,
    prism: &Prism<S>,
    cylinder: &Cylinder<S>,
    limit: S,
) -> Gap<S> {
    let (corners, normals) = (prism.corners(), prism.normals());
    let faces = FACES.iter().zip(normals);
    let faces = faces.map(|(face, normal)| (normal, normal.dot(corners[face[0]])));
    let edges = EDGES.into_iter().map(|[from, to, left, right]| {
        let start = corners[from];
        let (along, _) = (corners[to] - start).normalize();
        let cosine = normals[left].dot(normals[right]);
        PolyhedronEdge {
            start,
            along,
            moment: start.cross(along),
            faces: [left, right],
            rotation: (cosine, (S::ONE - cosine * cosine).max(S::ZERO).sqrt()),
        }
    });
    let cylinder = FramedCylinder {
        axis: pair.rotation.column(2),
        middle: pair.offset,
        radius: cylinder.radius,
        half: cylinder.half_length,
    };
    let corners = corners.iter().copied();
    let best = cylinder.search(corners, faces, edges, limit, pair.tolerance);
    Gap {
        normal: -best.normal,
        gap: best.gap,
        is_exact: true,
    }
}

/// Returns the largest gap of a cylinder and a box if it is not positive, else any positive one.
pub(super) fn box_gap<S: Scalar>(
    pair: &Pair<S>,
    cylinder: &Cylinder<S>,
    cuboid: &Cuboid<S>,
    limit: S,
) -> Gap<S> {
    let size = cuboid.half_lengths;
    // For each axis, first along it, then against it.
    let sign = |bits: usize, k: usize| [S::ONE, -S::ONE][bits >> k & 1];
    let unit = |k: usize| Mat3::IDENTITY.rows[k];
    let corners = (0..8).map(|k| size.scale_by(Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2))));
    let faces = (0..6).map(|k| (unit(k / 2) * sign(k, 0), size[k / 2]));
    let edges = (0..12).map(|edge| {
        let (i, j, k) = (edge / 4, (edge / 4 + 1) % 3, (edge / 4 + 2) % 3);
        let (to_j, to_k) = (edge & 1, edge >> 1 & 1);
        let (along, face_j, face_k) = (unit(i), 2 * j + to_j, 2 * k + to_k);
        let start = unit(j) * (size[j] * sign(to_j, 0)) + unit(k) * (size[k] * sign(to_k, 0));
        let faces = if to_j == to_k {
            [face_j, face_k]
        } else {
            [face_k, face_j]
        };
        PolyhedronEdge {
            start,
            along,
            moment: start.cross(along),
            faces,
            rotation: (S::ZERO, S::ONE),
        }
    });
    FramedCylinder::first(pair, cylinder).gap(pair, corners, faces, edges, limit)
}

/// Returns the largest gap of a cylinder and a hull if it is not positive, else any positive one; `None` if the hull
/// has many faces.
pub(super) fn hull_gap<S: Scalar>(
    pair: &Pair<S>,
    cylinder: &Cylinder<S>,
    hull: &Hull,
    limit: S,
) -> Option<Gap<S>> {
    if hull.creases().is_empty() {
        return None;
    }
    let real = |v: Vec3<f64>| Vec3::from_f64(v.to_array());
    let corners = hull.vertices().iter().map(|&v| real(v));
    let faces = (0..hull.face_count()).map(|k| (real(hull.normal(k)), S::new(hull.offset(k))));
    let edges = hull.creases().iter().map(|crease| PolyhedronEdge {
        start: real(crease.start),
        along: real(crease.along),
        moment: real(crease.moment),
        faces: crease.faces,
        rotation: (S::new(crease.rotation.0), S::new(crease.rotation.1)),
    });
    Some(FramedCylinder::first(pair, cylinder).gap(pair, corners, faces, edges, limit))
}

/// A cylinder in the frame of a polyhedron.
struct FramedCylinder<S> {
    axis: Vec3<S>,
    middle: Vec3<S>,
    radius: S,
    half: S,
}

/// A face, and the point at which the cylinder touches along its normal.
struct Face<S> {
    outward: Vec3<S>,
    /// The distance that the cylinder must move to separate across the face, m.
    depth: S,
    /// The cross product of the cylinder's point that is furthest against the face with the normal.
    moment: Vec3<S>,
}

/// An edge of the polyhedron.
struct PolyhedronEdge<S> {
    /// One of its ends.
    start: Vec3<S>,
    /// The unit direction to the other end.
    along: Vec3<S>,
    /// The cross product of `start` and `along`.
    moment: Vec3<S>,
    /// The index of the face to its left, and of the one to its right, seen from outside.
    faces: [usize; 2],
    /// The cosine and the sine of the angle between their normals.
    rotation: (S, S),
}

impl<S: Scalar> PolyhedronEdge<S> {
    /// Returns true if the gap through the edge may have its maximum between its faces, at no more than `depth`.
    #[inline(always)]
    fn may_touch(&self, [m, n]: [&Face<S>; 2], depth: S) -> bool {
        let (cosine, sine) = self.rotation;
        // The distance inside the edge at which the cylinder touches a face.
        let within = [
            self.along.dot(m.moment) + m.outward.dot(self.moment),
            -self.along.dot(n.moment) - n.outward.dot(self.moment),
        ];
        let near = |within: S, face: &Face<S>| within * sine <= depth - face.depth * cosine;
        // Test both without an unpredictable branch.
        near(within[0], m) & near(within[1], n)
    }
}

impl<S: Scalar> FramedCylinder<S> {
    /// Returns the first body of a pair, in the frame of the second.
    fn first(pair: &Pair<S>, shape: &Cylinder<S>) -> Self {
        FramedCylinder {
            axis: pair.rotation.rows[2],
            middle: -pair.rotation.transpose_mul(pair.offset),
            radius: shape.radius,
            half: shape.half_length,
        }
    }

    /// Runs the search in the frame of the first body of a pair.
    #[inline(always)]
    fn gap(
        &self,
        pair: &Pair<S>,
        corners: impl Iterator<Item = Vec3<S>> + Clone,
        faces: impl Iterator<Item = (Vec3<S>, S)>,
        edges: impl Iterator<Item = PolyhedronEdge<S>>,
        limit: S,
    ) -> Gap<S> {
        let best = self.search(corners, faces, edges, limit, pair.tolerance);
        Gap {
            normal: pair.rotation * best.normal,
            gap: best.gap,
            is_exact: true,
        }
    }

    /// Returns the direction from the cylinder to the polyhedron with the largest gap if it is not positive, else any
    /// with a positive gap; one beyond `limit` ends the search.
    ///
    /// `faces` yields the outward unit normal of each face and the extent of the polyhedron along it.
    #[inline(always)]
    fn search(
        &self,
        corners: impl Iterator<Item = Vec3<S>> + Clone,
        faces: impl Iterator<Item = (Vec3<S>, S)>,
        edges: impl Iterator<Item = PolyhedronEdge<S>>,
        limit: S,
        tolerance: S,
    ) -> LargestGap<S> {
        let mut best = LargestGap::new(tolerance);
        let mut tested = ArrayVec::<Face<S>, FEW_FACES>::new();
        for (outward, offset) in faces {
            let face = self.face(outward, offset);
            best.offer(-face.depth, || -outward);
            if best.gap > limit {
                return best;
            }
            tested.push(face);
        }
        self.corners(corners, &mut best);
        for edge in edges {
            let faces = edge.faces.map(|k| &tested[k]);
            if edge.may_touch(faces, best.depth()) {
                self.edge(&edge, faces, &mut best);
            }
        }
        best
    }

    #[inline(always)]
    fn face(&self, outward: Vec3<S>, offset: S) -> Face<S> {
        let along = self.axis.dot(outward);
        let across = self.axis.cross(outward);
        let level = across.norm();
        let reach = self.radius * level + self.half * along.abs();
        let arm = self.radius * along / level.max(S::MIN_POSITIVE) - self.half.copysign(along);
        Face {
            outward,
            depth: reach + offset - outward.dot(self.middle),
            moment: self.middle.cross(outward) + across * arm,
        }
    }

    /// Tries the caps, and the corner nearest to the axis against the side.
    #[inline(always)]
    fn corners(&self, corners: impl Iterator<Item = Vec3<S>> + Clone, best: &mut LargestGap<S>) {
        let (mut low, mut high) = (S::INFINITY, -S::INFINITY);
        let mut least = (S::INFINITY, Vec3::ZERO);
        for corner in corners.clone() {
            let from_middle = corner - self.middle;
            let along = self.axis.dot(from_middle);
            (low, high) = (low.min(along), high.max(along));
            let square = from_middle.norm_squared() - along * along;
            if square < least.0 {
                least = (square, from_middle);
            }
        }
        best.offer(low - self.half, || self.axis);
        best.offer(-high - self.half, || -self.axis);
        let moment = self.axis.cross(least.1);
        let (normal, distance) = moment.cross(self.axis).normalize();
        // A corner on the axis is equally far from all of the side.
        let normal = if distance > S::ZERO {
            normal
        } else {
            self.axis.any_perpendicular()
        };
        if distance - self.radius > best.gap {
            let along = corners.map(|corner| normal.dot(corner));
            let nearest = along.fold(S::INFINITY, |least, x| least.min(x));
            let gap = nearest - normal.dot(self.middle) - self.radius;
            best.offer(gap, || normal);
        }
    }

    /// Tries an edge against the side and the cap circles, along directions between its faces' inward normals.
    fn edge(&self, edge: &PolyhedronEdge<S>, [m, n]: [&Face<S>; 2], best: &mut LargestGap<S>) {
        let across = edge.along.cross(self.axis);
        let (cosine, sine) = (edge.along.dot(self.axis).abs(), across.norm());
        if sine <= S::EPSILON {
            return;
        }
        let across = across * (S::ONE / sine);
        let inward = [m.outward.cross(edge.along), edge.along.cross(n.outward)];
        let from_middle = edge.start - self.middle;
        // Seen along the edge, with x across the axis, the edge is at positive x.
        let x = across.dot(from_middle);
        let side = S::ONE.copysign(x);
        let (x, out) = (x.abs(), inward.map(|d| across.dot(d) * side));
        if out[0].min(out[1]) >= S::ZERO {
            best.offer(x - self.radius, || across * side);
        } else if out[0].max(out[1]) <= S::ZERO {
            best.offer(-x - self.radius, || -across * side);
        }
        if cosine <= S::EPSILON || self.radius <= S::ZERO {
            return;
        }
        let along = across.cross(edge.along);
        let (y, up) = (along.dot(from_middle), inward.map(|d| along.dot(d)));
        let ellipse = Ellipse::new(cosine, sine);
        let unit = S::ONE / self.radius;
        for sign in [S::ONE, -S::ONE] {
            let nowhere = |k: usize| out[k] < S::ZERO && up[k] * sign < S::ZERO;
            if nowhere(0) || nowhere(1) {
                continue;
            }
            let point = (x * unit, (y * sign - self.half * sine) * unit);
            let Some((u, v)) = ellipse.normal_through(point) else {
                continue;
            };
            let normal = across * (u * side) + along * (v * sign);
            if inward.iter().all(|d| normal.dot(*d) >= S::ZERO) {
                let reach = self.half * self.axis.dot(normal).abs()
                    + self.radius * self.axis.cross(normal).norm();
                best.offer(normal.dot(from_middle) - reach, || normal);
            }
        }
    }
}
