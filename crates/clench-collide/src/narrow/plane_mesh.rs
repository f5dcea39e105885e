//! A hull on a plane.
//!
//! The vertex that is deepest, and with it the face that lies on the plane, of which those corners are kept that
//! are far from each other. If there are fewer points than there is room for, others within the margin around the deepest
//! vertex: the vertices of a hull on one side of a plane hang together, so walking over neighbours finds them.

use super::{
    Placed,
    convex::MOST_CORNERS,
    one_by_one::{Point, Points, one_by_one},
};
use crate::{Asset, Contacts, Hull, PATCH_POINTS};
use arrayvec::ArrayVec;
use clench_math::{Real, Scalar, Vec3};

/// The deepest vertex and the corners of a face.
const MOST: usize = MOST_CORNERS + 1;
/// Distances that differ by less than this share are equal.
const TIE: f64 = 1e-6;

pub(super) fn plane_mesh<T: Real>(a: Placed<T>, b: Placed<T>, margin: T, out: &mut Contacts<T>) {
    one_by_one(a, b, margin, out, points);
}

/// A vertex in the hull's frame, and its height above the plane.
#[derive(Clone, Copy)]
struct Spot<S> {
    at: Vec3<S>,
    height: S,
    /// The square of the distance to the nearest spot that is kept.
    alone: S,
}

fn points<S: Scalar>(plane: Placed<S>, mesh: Placed<S>, margin: S, points: &mut Points<S>) {
    let Asset::Hull(hull) = mesh.shape.asset else {
        return;
    };
    let normal = plane.pose.axis();
    let up = mesh.pose.rotation.transpose_mul(normal);
    let origin = normal.dot(mesh.pose.position - plane.pose.position);
    let near = |vertex: u32| {
        let at = Vec3::from_f64(hull.vertices()[vertex as usize].to_array());
        let height = origin + up.dot(at);
        let alone = S::INFINITY;
        (height <= margin).then_some(Spot { at, height, alone })
    };
    let mut spots = ArrayVec::new();
    around_deepest(hull, -up, near, &mut spots);
    spread(&mut spots);
    for Spot { at, height, .. } in spots {
        let position = mesh.pose.point(at) - normal * (height * S::new(0.5));
        points.push(Point {
            position,
            normal,
            distance: height,
        });
    }
}

/// The vertex furthest along `down`, those of the face that lies across it, and others around: all that are near.
fn around_deepest<S: Scalar>(
    hull: &Hull,
    down: Vec3<S>,
    near: impl Fn(u32) -> Option<Spot<S>>,
    spots: &mut ArrayVec<Spot<S>, MOST>,
) {
    let down = Vec3::from_array(down.to_array().map(S::to_f64));
    let deepest = hull.support(down);
    let mut seen = ArrayVec::<u32, MOST>::new();
    let mut look = |vertex: u32, seen: &mut ArrayVec<u32, MOST>| {
        // Most are not near.
        if let Some(spot) = near(vertex)
            && !seen.contains(&vertex)
        {
            seen.push(vertex);
            spots.push(spot);
        }
    };
    look(deepest as u32, &mut seen);
    if seen.is_empty() {
        return;
    }
    if let Some(face) = hull.face_across(deepest, down) {
        let corners = hull.corners(face);
        for corner in corners.iter().step_by(corners.len().div_ceil(MOST_CORNERS)) {
            look(*corner, &mut seen);
        }
    }
    let mut next = 0;
    while next < seen.len() {
        for &neighbor in hull.neighbors(seen[next] as usize) {
            if seen.len() >= PATCH_POINTS {
                return;
            }
            look(neighbor, &mut seen);
        }
        next += 1;
    }
}

/// Leaves at most [`PATCH_POINTS`]: the first, the one furthest from it, the one furthest from both, and so on.
fn spread<S: Scalar>(spots: &mut ArrayVec<Spot<S>, MOST>) {
    if spots.len() <= PATCH_POINTS {
        return;
    }
    for kept in 1..PATCH_POINTS {
        let last = spots[kept - 1].at;
        let mut best = (S::ZERO, kept);
        for (k, spot) in spots.iter_mut().enumerate().skip(kept) {
            spot.alone = Real::min((spot.at - last).norm_squared(), spot.alone);
            // Rounding must not choose between equals.
            if spot.alone > best.0 * S::new(1.0 + TIE) {
                best = (spot.alone, k);
            }
        }
        spots.swap(kept, best.1);
    }
    spots.truncate(PATCH_POINTS);
}
