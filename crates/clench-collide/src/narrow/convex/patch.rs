//! The contact points: one where a corner or a curved body touches, else those of the overlap of two features.

use super::overlap::{Overlap, PatchPoints};
use super::pair::{Gap, Pair};
use super::simplex::Simplex;
use crate::narrow::per_lane::{Point, Points};
use crate::narrow::placed::AnyPlaced;
use clench_math::{Scalar, Vec3};

/// Adds the contacts of a pair with known largest gap; `simplex`, if the search had one, yields the nearest points of
/// the cores where the features do not.
pub(super) fn patch<S: Scalar>(
    pair: &Pair<S>,
    a: AnyPlaced<S>,
    best: Gap<S>,
    simplex: Option<&Simplex<S>>,
    margin: S,
    points: &mut Points<S>,
) {
    // Normalize again, since squares of very short vectors lose digits.
    let n = best.normal.normalize().0;
    let radii = (pair.a.radius, pair.b.radius);
    let half = best.gap * S::new(0.5);
    let shift = (radii.0 - radii.1) * S::new(0.5);
    let distance = best.gap - radii.0 - radii.1;
    // The frame of a sphere has the axes of the world: see [`Pair::new`].
    if pair.a.is_point() {
        points.push(Point {
            position: a.pose.position + n * (half + shift),
            normal: n,
            distance,
        });
        return;
    }
    let normal = a.pose.rotation * n;
    let mut add_one = |middle: Vec3<S>| {
        points.push(Point {
            position: a.pose.point(middle + n * shift),
            normal,
            distance,
        });
    };
    if pair.b.is_point() {
        return add_one(pair.offset - n * half);
    }
    let feature_a = pair.a.feature(n);
    // The position of a corner does not depend on the normal.
    if let (&[corner], false) = (&feature_a.corners[..], pair.a.is_curved()) {
        return add_one(corner + n * half);
    }
    let feature_b = pair.b.feature(-pair.rotation.transpose_mul(n));
    let place = |p| pair.offset + pair.rotation * p;
    // A corner, or the one point where a curved body touches.
    let middle = match (&feature_a.corners[..], &feature_b.corners[..]) {
        (&[p], &[q]) => Some((p + place(q)) * S::new(0.5)),
        (&[p], _) => Some(p + n * half),
        (_, &[q]) => Some(place(q) - n * half),
        _ => None,
    };
    if let Some(middle) = middle {
        return add_one(middle);
    }
    let features = [&feature_a, &feature_b];
    let (mut overlap, mut normal) = (Overlap::new(pair, features, n, best.gap), normal);
    if S::IS_DUAL
        && let Some(level) = overlap.level_faces(features)
    {
        overlap = Overlap::new(pair, features, level.normal, level.gap);
        normal = a.pose.rotation * level.normal;
    }
    let mut found = PatchPoints::new();
    overlap.points(simplex, margin + radii.0 + radii.1, &mut found);
    for point in &found {
        let (from, to) = (point.heights.0 + radii.0, point.heights.1 - radii.1);
        let middle = Vec3::new(point.x, point.y, (from + to) * S::new(0.5));
        points.push(Point {
            position: a.pose.point(overlap.unproject(middle)),
            normal,
            distance: to - from,
        });
    }
}
