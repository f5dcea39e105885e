//! Convex hulls on a plane.
//!
//! If a face with few corners lies on the plane, the contacts are its corners and the deepest vertex; for many corners,
//! points of its outline (see [`Outline`]). Other vertices within the margin around the deepest one fill the remaining
//! capacity: those on one side of a plane are connected by edges, so traversing neighbours finds them.

use super::outline::Outline;
use super::per_lane::{Point, Points, per_lane_where};
use super::placed::Placed;
use super::polygon::Polygon;
use crate::broad::allowance;
use crate::contact::{Contacts, PATCH_POINTS};
use crate::hull::Hull;
use crate::shape::{MAX_CORNERS, Mesh, Plane, Solid};
use arrayvec::ArrayVec;
use clench_math::{Mask, Real, Scalar, Vec3, kernel};

/// The distance below which corners of a face are merged, relative to the size of the hull.
pub(super) const SAME: f64 = 1e-5;
/// The allowed error of the outline's depth, relative to the size of the hull.
pub(super) const MISSED: f64 = 1e-6;

#[kernel]
pub(super) fn plane_mesh<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Mesh<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    // The lowest corner of the mesh's bounding box; NaN is left to the search.
    let up = b.pose.rotation.transpose_mul(a.pose.axis());
    let height = a.pose.axis().dot(b.pose.position - a.pose.position);
    let above = (height - b.shape.reach_along(up) * allowance()).gt(margin);
    if !above.all() {
        per_lane_where(!above, a, b, margin, out, |_, a, b, margin, found| {
            points(a, b, margin, found);
        });
    }
}

/// A point of the hull, in its frame, and its height above the plane.
#[derive(Clone, Copy)]
struct Candidate<S> {
    at: Vec3<S>,
    height: S,
}

type Candidates<S> = ArrayVec<Candidate<S>, PATCH_POINTS>;

fn points<S: Scalar>(
    plane: Placed<Plane<S>, S>,
    mesh: Placed<Mesh<S>, S>,
    margin: S,
    points: &mut Points<S>,
) {
    let Some(hull) = mesh.shape.hull else {
        return;
    };
    let normal = plane.pose.axis();
    let up = mesh.pose.rotation.transpose_mul(normal);
    let origin = normal.dot(mesh.pose.position - plane.pose.position);
    let candidate = |at: Vec3<S>| Candidate {
        at,
        height: origin + up.dot(at),
    };
    let down = Vec3::from_array(up.to_array().map(|x| -x.to_f64()));
    let deepest = hull.support(down);
    let lowest = candidate(corner(hull, deepest as u32));
    if lowest.height > margin {
        return;
    }
    let mut candidates = Candidates::new();
    let face = hull.face_across(deepest, down);
    match face {
        Some(face) if hull.corners(face).len() > PATCH_POINTS => {
            let slack = mesh.shape.extent.norm();
            sample(hull, face, lowest, slack, candidate, &mut candidates);
            candidates.retain(|candidate| candidate.height <= margin);
        }
        _ => {
            let near = |vertex: u32| {
                let candidate = candidate(corner(hull, vertex));
                (candidate.height <= margin).then_some(candidate)
            };
            collect_near(hull, deepest, face, near, &mut candidates);
        }
    }
    for Candidate { at, height } in candidates {
        let position = mesh.pose.point(at) - normal * (height * S::new(0.5));
        points.push(Point {
            position,
            normal,
            distance: height,
        });
    }
}

fn corner<S: Scalar>(hull: &Hull, vertex: u32) -> Vec3<S> {
    Vec3::from_f64(hull.vertices()[vertex as usize].to_array())
}

/// Collects near vertices up to the capacity: the deepest, those of the face on the plane, then their neighbours.
fn collect_near<S: Scalar>(
    hull: &Hull,
    deepest: usize,
    face: Option<usize>,
    near: impl Fn(u32) -> Option<Candidate<S>>,
    candidates: &mut Candidates<S>,
) {
    let mut visited = ArrayVec::<u32, PATCH_POINTS>::new();
    let mut visit = |vertex: u32, visited: &mut ArrayVec<u32, PATCH_POINTS>| {
        // Tested first, because most vertices are not near.
        if let Some(candidate) = near(vertex)
            && !visited.is_full()
            && !visited.contains(&vertex)
        {
            visited.push(vertex);
            candidates.push(candidate);
        }
    };
    visit(deepest as u32, &mut visited);
    for &corner in face.map_or(&[][..], |face| hull.corners(face)) {
        visit(corner, &mut visited);
    }
    let mut next = 0;
    while next < visited.len() {
        for &neighbor in hull.neighbors(visited[next] as usize) {
            if visited.is_full() {
                return;
            }
            visit(neighbor, &mut visited);
        }
        next += 1;
    }
}

/// Samples the outline of a face with many corners, starting along its first edge. If that misses the deepest vertex,
/// samples again starting with it.
fn sample<S: Scalar>(
    hull: &Hull,
    face: usize,
    lowest: Candidate<S>,
    size: S,
    candidate: impl Fn(Vec3<S>) -> Candidate<S>,
    candidates: &mut Candidates<S>,
) {
    let corners = hull.corners(face);
    let (origin, next): (Vec3<S>, Vec3<S>) = (corner(hull, corners[0]), corner(hull, corners[1]));
    let normal = Vec3::from_f64(hull.normal(face).to_array());
    let along = (next - origin).normalize().0;
    let across = normal.cross(along);
    let flat = |p: Vec3<S>| Vec3::new(along.dot(p - origin), across.dot(p - origin), S::ZERO);
    let mut polygon = Polygon::empty();
    for &vertex in corners.iter().step_by(corners.len().div_ceil(MAX_CORNERS)) {
        polygon.push(flat(corner(hull, vertex)));
    }
    let outline = Outline::of_points(polygon.corners(), size * S::new(SAME));
    let place = |p: &Vec3<S>| candidate(origin + along * p.x + across * p.y);
    let first = Vec3::new(S::ONE, S::ZERO, S::ZERO);
    candidates.extend(outline.sample(first).iter().map(place));
    let heights = candidates.iter().map(|c| c.height);
    let least = heights.fold(S::INFINITY, |least, height| least.min(height));
    if least - lowest.height > size * S::new(MISSED) {
        candidates.clear();
        let first = flat(lowest.at) - outline.middle();
        candidates.extend(outline.sample(first).iter().map(place));
        candidates[0] = lowest;
    } else if let Some(deepest) = candidates.iter_mut().find(|c| c.height <= least) {
        // The remaining difference is too small to move a point, but the contact gets the true depth.
        deepest.height = least.min(lowest.height);
    }
}
