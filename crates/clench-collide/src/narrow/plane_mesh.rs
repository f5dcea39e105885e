//! A hull on a plane.
//!
//! The vertex that is deepest, and with it the face that lies on the plane, of which those corners are kept that
//! are far from each other. If there are fewer points than there is room for, others within the margin around the deepest
//! vertex: the vertices of a hull on one side of a plane hang together, so walking over neighbours finds them.

use super::{
    Placed,
    convex::MAX_CORNERS,
    per_lane::{Point, Points, per_lane},
};
use crate::{Asset, Contacts, Hull, PATCH_POINTS};
use arrayvec::ArrayVec;
use clench_math::{Real, Scalar, Vec3};

/// The deepest vertex and the corners of a face.
const MAX_CANDIDATES: usize = MAX_CORNERS + 1;
/// Distances that differ by less than this share are equal.
const TIE: f64 = 1e-6;

pub(super) fn plane_mesh<T: Real>(a: Placed<T>, b: Placed<T>, margin: T, out: &mut Contacts<T>) {
    per_lane(a, b, margin, out, points);
}

/// A vertex in the hull's frame, and its height above the plane.
#[derive(Clone, Copy)]
struct Candidate<S> {
    at: Vec3<S>,
    height: S,
    /// The square of the distance to the nearest candidate that is kept.
    separation: S,
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
        let separation = S::INFINITY;
        (height <= margin).then_some(Candidate {
            at,
            height,
            separation,
        })
    };
    let mut candidates = ArrayVec::new();
    around_deepest(hull, -up, near, &mut candidates);
    sample_farthest(&mut candidates);
    for Candidate { at, height, .. } in candidates {
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
    near: impl Fn(u32) -> Option<Candidate<S>>,
    candidates: &mut ArrayVec<Candidate<S>, MAX_CANDIDATES>,
) {
    let down = Vec3::from_array(down.to_array().map(S::to_f64));
    let deepest = hull.support(down);
    let mut visited = ArrayVec::<u32, MAX_CANDIDATES>::new();
    let mut visit = |vertex: u32, visited: &mut ArrayVec<u32, MAX_CANDIDATES>| {
        // Most are not near.
        if let Some(candidate) = near(vertex)
            && !visited.contains(&vertex)
        {
            visited.push(vertex);
            candidates.push(candidate);
        }
    };
    visit(deepest as u32, &mut visited);
    if visited.is_empty() {
        return;
    }
    if let Some(face) = hull.face_across(deepest, down) {
        let corners = hull.corners(face);
        for corner in corners.iter().step_by(corners.len().div_ceil(MAX_CORNERS)) {
            visit(*corner, &mut visited);
        }
    }
    let mut next = 0;
    while next < visited.len() {
        for &neighbor in hull.neighbors(visited[next] as usize) {
            if visited.len() >= PATCH_POINTS {
                return;
            }
            visit(neighbor, &mut visited);
        }
        next += 1;
    }
}

/// Leaves at most [`PATCH_POINTS`]: the first, the one furthest from it, the one furthest from both, and so on.
fn sample_farthest<S: Scalar>(candidates: &mut ArrayVec<Candidate<S>, MAX_CANDIDATES>) {
    if candidates.len() <= PATCH_POINTS {
        return;
    }
    for kept in 1..PATCH_POINTS {
        let last = candidates[kept - 1].at;
        let mut best = (S::ZERO, kept);
        for (k, candidate) in candidates.iter_mut().enumerate().skip(kept) {
            candidate.separation =
                Real::min((candidate.at - last).norm_squared(), candidate.separation);
            // Rounding must not choose between equals.
            if candidate.separation > best.0 * S::new(1.0 + TIE) {
                best = (candidate.separation, k);
            }
        }
        candidates.swap(kept, best.1);
    }
    candidates.truncate(PATCH_POINTS);
}
