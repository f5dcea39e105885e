//! The largest gap of two overlapping cylinders among a few candidate directions, unless it may be across two cap
//! circles.
//!
//! As for a cylinder and a polyhedron (see [`super::cylinder_polyhedron`]), few directions are normals at a smooth
//! point of the boundary of the difference. With the axes z and u these are
//!
//! ```text
//! z, u       a cap                     n across z or u  a circle on the side of the other: the normal of an ellipse
//! z × u      a side across a side      any other n      a circle across a circle
//! ```
//!
//! Along its own axis one cylinder is projected to a circle, the other to a rectangle with half ellipses at its ends.
//! Their middle lines coincide, so the smallest depth is in the quarter of the offset.
//!
//! A direction across two cap circles with a depth below d joins one to the other: each passes, inside, within d of
//! both the cap and the side of the other cylinder. If they do not, the other directions are sufficient.

use super::{
    ellipse::Ellipse,
    largest_gap::LargestGap,
    pair::{Gap, Pair},
};
use crate::shape::{Cylinder, Solid};
use clench_math::{Mat3, Scalar, Vec3};

/// Returns the largest gap of two overlapping cylinders, or a positive one if they are apart. It is not exact if it
/// may be across two cap circles, or if no common point is known.
pub(super) fn largest_gap<S: Scalar>(pair: &Pair<S>, shapes: [&Cylinder<S>; 2]) -> Gap<S> {
    let axes = [Vec3::new(S::ZERO, S::ZERO, S::ONE), pair.rotation.column(2)];
    let (cosine, sine) = (
        axes[1].z,
        (axes[1].x.squared() + axes[1].y.squared()).sqrt(),
    );
    // Such a tilt moves no point noticeably, or is an error of the poses.
    if sine * pair.largest <= pair.tolerance || sine <= pair.rotation_error * S::new(4.0) {
        return parallel(pair);
    }
    let least = pair.largest * S::EPSILON;
    let inverse = S::ONE / sine;
    let across = Vec3::new(-axes[1].y * inverse, axes[1].x * inverse, S::ZERO);
    let cylinder = |i: usize, side: Vec3<S>, offset: Vec3<S>| SkewCylinder {
        radius: shapes[i].radius.max(least),
        half: shapes[i].half_length,
        side,
        offset: [offset.dot(across), offset.dot(side), offset.dot(axes[i])],
    };
    let cylinders = [
        cylinder(0, across.cross(axes[0]), pair.offset),
        cylinder(1, axes[1].cross(across), -pair.offset),
    ];

    let mut best = LargestGap::new(pair.tolerance);
    let mut offer = |direction: Vec3<S>| {
        let normal = direction * S::ONE.copysign(direction.dot(pair.offset));
        best.offer(pair.gap(normal).gap, || normal);
    };
    axes.into_iter().for_each(&mut offer);
    offer(across);
    let [first, second] = &cylinders;
    // The normal at the ends of a flat ellipse is ambiguous; a slightly rounder one makes it unique.
    let ellipse = Ellipse::new(cosine.abs().max(S::EPSILON), sine);
    for (own, other) in [(first, second), (second, first)] {
        let [x, y, _] = own.offset;
        let unit = S::ONE / other.radius;
        let point = (x.abs() * unit, (y.abs() - other.half * sine) * unit);
        if let Some((along_x, along_y)) = ellipse.normal_through(point) {
            offer(across * along_x.copysign(x) + own.side * along_y.copysign(y));
        }
    }
    let is_exact = best.gap > S::ZERO
        || (!circles_cross(&cylinders, (cosine, sine), -best.gap)
            && (axes_pass(&cylinders, sine) || deepest_inside(pair, shapes, best.normal)));
    Gap {
        normal: best.normal,
        gap: best.gap,
        is_exact,
    }
}

/// Returns the same for parallel axes: the difference is then a cylinder too, which is left across a cap or its side.
fn parallel<S: Scalar>(pair: &Pair<S>) -> Gap<S> {
    let (x, y) = (pair.offset.x, pair.offset.y);
    let (side, distance) = Vec3::new(x, y, S::ZERO).normalize();
    // If the axes coincide all directions are equal; use one that rotates with the first body.
    let side = if distance > pair.tolerance {
        side
    } else {
        Mat3::IDENTITY.rows[0]
    };
    let along = Vec3::new(S::ZERO, S::ZERO, S::ONE.copysign(pair.offset.z));
    let mut best = pair.gap(along);
    best.improve(pair.gap(side), S::ZERO);
    best.is_exact = true;
    best
}

/// Returns true if a direction across two cap circles may have a smaller depth than `depth`.
fn circles_cross<S: Scalar>([a, b]: &[SkewCylinder<S>; 2], angle: (S, S), depth: S) -> bool {
    ENDS.into_iter().any(|ends| {
        let [end, other] = ends.map(S::new);
        a.near_circle(b, [end, other], angle, depth) && b.near_circle(a, [other, end], angle, depth)
    })
}

/// Returns true if the nearest points of the axes are within both cylinders. Then they overlap, unless a gap is across
/// both axes.
fn axes_pass<S: Scalar>([a, b]: &[SkewCylinder<S>; 2], sine: S) -> bool {
    a.offset[1].abs() <= b.half * sine && b.offset[1].abs() <= a.half * sine
}

/// Returns true if the deepest point of one, along the normal, is within the other.
fn deepest_inside<S: Scalar>(pair: &Pair<S>, [a, b]: [&Cylinder<S>; 2], normal: Vec3<S>) -> bool {
    let deepest = pair.vertex(normal);
    a.contains(pair.offset + pair.rotation * deepest.b)
        || b.contains(pair.rotation.transpose_mul(deepest.a - pair.offset))
}

/// The signs of both cylinders' caps.
const ENDS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

/// A cylinder, and the offset of the other one from its middle: across both axes, along `side`, and along its own axis.
struct SkewCylinder<S> {
    radius: S,
    half: S,
    /// The unit direction across its axis towards the axis of the other.
    side: Vec3<S>,
    offset: [S; 3],
}

impl<S: Scalar> SkewCylinder<S> {
    /// Returns true if a cap circle of another cylinder may pass, inside, within `depth` of this one's cap and side at
    /// one of its ends; `ends` select that end and the circle.
    ///
    /// The cap circle runs through (x + r C, y − r γ S, z + r σ S) with C = cos θ and S = sin θ, where γ and σ are the
    /// cosine and the sine between the axes. Within `depth` of the cap S is in an interval. There the cap circle,
    /// projected along the axis, is in one of two rectangles, which must overlap a ring.
    #[inline]
    fn near_circle(&self, other: &Self, ends: [S; 2], (cosine, sine): (S, S), depth: S) -> bool {
        let [x, y, z] = self.offset;
        let arm = other.half * ends[1];
        let (y, z) = (y + arm * sine, (z + arm * cosine) * ends[0]);
        let inverse = S::ONE / (other.radius * sine);
        let from = ((self.half - depth - z) * inverse).max(-S::ONE);
        let to = ((self.half - z) * inverse).min(S::ONE);
        if from > to {
            return false;
        }
        let level = |s: S| (S::ONE - s * s).max(S::ZERO).sqrt() * other.radius;
        let (c_from, c_to) = (level(from), level(to));
        let over_top = from < S::ZERO && to > S::ZERO;
        let largest = S::select(over_top, other.radius, c_from.max(c_to));
        let least = c_from.min(c_to);
        let slope = -cosine * ends[0] * other.radius;
        let (y_from, y_to) = (y + slope * from, y + slope * to);
        let ys = (y_from.min(y_to), y_from.max(y_to));
        let inner = (self.radius - depth).max(S::ZERO);
        [(x + least, x + largest), (x - largest, x - least)]
            .into_iter()
            .any(|xs| {
                let (x, y) = (distances(xs), distances(ys));
                x.0 * x.0 + y.0 * y.0 <= self.radius * self.radius
                    && x.1 * x.1 + y.1 * y.1 >= inner * inner
            })
    }
}

/// Returns the minimum and maximum magnitude in an interval.
#[inline]
fn distances<S: Scalar>((low, high): (S, S)) -> (S, S) {
    (low.max(-high).max(S::ZERO), high.max(-low))
}
