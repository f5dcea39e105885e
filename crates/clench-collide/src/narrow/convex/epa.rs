//! The depth of two overlapping cores: the expanding polytope algorithm (van den Bergen 2001).
//!
//! The difference of the cores contains the origin, and its boundary point nearest to the origin gives the penetration
//! depth and direction. A polytope of its vertices grows: the face nearest to the origin is replaced by faces to the
//! vertex that is furthest along its normal. The extent of the difference along any direction m is an upper bound of
//! the depth, the polytope's nearest face a lower bound:
//!
//! ```text
//! nearest face  ≤  depth  ≤  m·w(−m).
//! ```
//!
//! Bodies with flat faces end exactly, at a face that cannot be moved. For curved bodies Newton's method gives an
//! accurate upper bound, and the lower bound need only exclude noticeably smaller depths. If the polytope's capacity is
//! exhausted before, in the middle of thin round bodies, the directions across two creases of the gap are tried too:
//! among nearly equal depths the smallest is there.

use super::{
    depth_proof::DepthProof,
    pair::{Gap, Pair, Vertex},
    polytope::{Polytope, VERTICES},
    refine::{ActiveEdges, refine},
    simplex::Simplex,
    touching::Touching,
};
use clench_math::{Mat3, Scalar, Vec3};

/// The maximum number of rounds. Most move a face, some find that it cannot be moved.
const ROUNDS: usize = 2 * VERTICES;
/// The maximum error of the depth of curved bodies, relative to the smaller body.
pub(crate) const SLACK: f64 = 1e-4;
/// The distance that a face can be moved, relative to the smaller body, below which Newton's method is tried.
pub(crate) const NEAR: f64 = 0.1;

/// The preferred minimum distance of the initial vertices, relative to the smaller body.
pub(crate) const FAR: f64 = 0.05;

/// Returns the largest gap of overlapping cores, which is negative. The simplex must contain the origin, and becomes
/// the face of the difference that the gap belongs to.
pub(super) fn epa<S: Scalar>(
    pair: &Pair<S>,
    start: Gap<S>,
    simplex: &mut Simplex<S>,
    proof: Option<&mut DepthProof>,
) -> Gap<S> {
    let mut polytope = Polytope::empty(pair);
    match enclose(pair, simplex.vertices()) {
        Ok(vertices) => polytope.begin(&vertices),
        Err(flat) => return flat,
    }
    let (found, triangle) = expand(pair, start, &mut polytope);
    *simplex = Simplex::unsolved(&triangle);
    let Some(bodies) = pair.polyhedra() else {
        return found;
    };
    let Some((touching, (exact, between))) = Touching::of(pair, &bodies, &found, &triangle) else {
        return found;
    };
    if let Some(proof) = proof {
        proof.store(&polytope, touching);
    }
    *simplex = Simplex::new(between);
    exact
}

/// Returns four vertices that span a volume, including the given ones if they span enough.
///
/// # Errors
/// Returns the gap across the difference, the largest, as an error if it has no volume.
fn enclose<S: Scalar>(pair: &Pair<S>, given: &[Vertex<S>]) -> Result<[Vertex<S>; 4], Gap<S>> {
    let least = pair.largest * S::EPSILON * S::new(16.0);
    let axes = Mat3::IDENTITY.rows;
    let first = given[0];
    let from_first = |v: &Vertex<S>| (v.w - first.w).norm();
    let second = furthest(pair, given, &axes, from_first, least)?;

    let (along, _) = (second.w - first.w).normalize();
    let side = along.any_perpendicular();
    let sides = [side, along.cross(side)];
    let from_line = |v: &Vertex<S>| (v.w - first.w).cross(along).norm();
    let third = furthest(pair, given, &sides, from_line, least)?;

    let (normal, _) = along.cross(third.w - first.w).normalize();
    let from_plane = |v: &Vertex<S>| (v.w - first.w).dot(normal).abs();
    let fourth = furthest(pair, given, &[normal], from_plane, least)?;
    Ok([first, second, third, fourth])
}

/// Returns the given vertex that is furthest; if it is not far, the furthest along or against any of the directions, if
/// further.
///
/// # Errors
/// Returns the gap along or against the first direction as an error if none is beyond `least`.
fn furthest<S: Scalar>(
    pair: &Pair<S>,
    vertices: &[Vertex<S>],
    directions: &[Vec3<S>],
    distance: impl Fn(&Vertex<S>) -> S,
    least: S,
) -> Result<Vertex<S>, Gap<S>> {
    let mut best = (S::ZERO, vertices[0]);
    for vertex in vertices {
        let reach = distance(vertex);
        if reach > best.0 {
            best = (reach, *vertex);
        }
    }
    if best.0 > pair.smallest * S::new(FAR) {
        return Ok(best.1);
    }
    for &direction in directions {
        for normal in [direction, -direction] {
            let vertex = pair.vertex(normal);
            let reach = distance(&vertex);
            if reach > best.0 {
                best = (reach, vertex);
            }
        }
    }
    if best.0 > least {
        return Ok(best.1);
    }
    let mut gap = pair.gap(directions[0]);
    gap.improve(pair.gap(-directions[0]), S::ZERO);
    Err(gap)
}

/// Expands the polytope until the depth is known. Returns the largest gap and the triangle that it belongs to.
fn expand<S: Scalar>(
    pair: &Pair<S>,
    start: Gap<S>,
    polytope: &mut Polytope<S>,
) -> (Gap<S>, [Vertex<S>; 3]) {
    let mut best = start;
    let mut touching = polytope.corners(0);
    // True if Newton's method has refined the best direction.
    let mut refined = false;
    let mut converged = false;
    for _ in 0..ROUNDS {
        let (nearest, distance) = polytope.nearest();
        // The tolerance for a smaller depth through the nearest face.
        let slack = if best.is_exact {
            (pair.smallest * S::new(SLACK)).max(pair.tolerance)
        } else {
            pair.tolerance
        };
        let corners = polytope.corners(nearest);
        converged = -best.gap - distance <= slack;
        if converged && !best.is_exact && distance < S::INFINITY {
            touching = corners;
        }
        if converged || polytope.is_full() {
            break;
        }
        let outward = polytope.normal(nearest);
        let vertex = pair.vertex(-outward);
        let raw = Gap {
            normal: -outward,
            gap: -outward.dot(vertex.w),
            is_exact: false,
        };
        let movable = -raw.gap - distance;
        let better = best.improve(raw, pair.tolerance);
        refined &= !better;
        converged = movable <= pair.tolerance;
        if better || (converged && !best.is_exact) {
            touching = corners;
        }
        if converged {
            break;
        }
        if !polytope.add(nearest, &vertex) {
            // Rounding prevents any vertex beyond it.
            polytope.close(nearest);
        }
        if better && pair.curved && movable < pair.smallest.max(distance) * S::new(NEAR) {
            let active = ActiveEdges::of(pair, &polytope.vertices(corners));
            refined |= best.improve(refine(pair, raw.normal, &active), pair.tolerance);
        }
    }
    let touching = polytope.vertices(touching);
    if !refined {
        best.refine_inexact(pair, &touching);
    }
    if !converged {
        for normal in pair.crossings() {
            best.improve(pair.gap(normal), pair.tolerance);
        }
    }
    (best, touching)
}
