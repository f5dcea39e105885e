//! Pairs of convex shapes, by their support functions: distance or depth, normal, and contact points.

mod body;
mod clipping;
mod constants;
mod cylinder_polyhedron;
mod cylinders;
mod depth_proof;
mod ellipse;
mod epa;
mod gjk;
mod largest_gap;
mod overlap;
mod pair;
mod patch;
mod polyhedron;
mod polytope;
mod prism;
mod refine;
mod simplex;
mod terrain;
mod touching;

use super::boxes::boxes_near;
use super::pair_memory::PairMemory;
use super::per_lane::{Points, per_lane_where};
use super::placed::AnyPlaced;
use crate::contact::Contacts;
use crate::shape::Shape;
use clench_math::{Mask, Real, Scalar, Vec3, kernel};
pub use constants::{CONVEX_CONSTANTS, CONVEX_COUNTS};
pub use depth_proof::{DepthProof, LaneProofs};
use epa::epa;
use gjk::{Cores, gjk};
use pair::{Gap, Pair};
use patch::patch;
use simplex::Simplex;
pub(super) use terrain::terrain;

/// Computes the contacts of two bounded convex shapes. The last separating direction in `memory` may show at once that
/// there are none. The proof of the last depth may show that the same features still touch. A search updates either.
#[kernel]
pub(super) fn convex<T: Real>(
    a: AnyPlaced<T>,
    b: AnyPlaced<T>,
    margin: T,
    memory: &mut PairMemory<T>,
    out: &mut Contacts<T>,
) {
    let PairMemory { axis, proofs } = memory;
    let mut near = !axis.separates(a, b, margin);
    if !near.any() {
        return;
    }
    near &= boxes_near(a, b, margin, axis);
    per_lane_where(near, a, b, margin, out, |lane, a, b, margin, found| {
        if let Err(direction) = points(a, b, margin, proofs.of_lane(lane), found) {
            axis.set(lane, direction);
        }
    });
}

/// Computes the contacts of one environment, with a proof of the depth in the last step, which it replaces.
///
/// # Errors
/// Returns a separating direction in the frame of the first as an error if the bodies are more than `margin` apart.
pub(super) fn points<S: Scalar>(
    a: AnyPlaced<S>,
    b: AnyPlaced<S>,
    margin: S,
    mut proof: Option<&mut DepthProof>,
    points: &mut Points<S>,
) -> Result<(), Vec3<S>> {
    let pair = Pair::new(a, b);
    if let Some(proof) = &mut proof
        && let Some((best, between)) = proof.confirm(&pair)
    {
        patch(&pair, a, best, Some(&Simplex::new(between)), margin, points);
        return Ok(());
    }
    let direct = match (&a.shape, &b.shape) {
        (Shape::Cylinder(a), Shape::Box(b)) => {
            Some(cylinder_polyhedron::box_gap(&pair, a, b, margin))
        }
        (Shape::Cylinder(a), Shape::Cylinder(b)) => Some(cylinders::largest_gap(&pair, [a, b])),
        (Shape::Cylinder(a), Shape::Mesh(b)) => {
            let gap = |hull| cylinder_polyhedron::hull_gap(&pair, a, hull, margin);
            b.hull.and_then(gap)
        }
        _ => None,
    };
    let direct = direct.filter(|direct| Real::is_finite(direct.gap));
    if let Some(apart) = direct.filter(|direct| direct.gap > margin) {
        return Err(apart.normal);
    }
    // If the bodies are apart, this gap is not always the distance.
    if let Some(certain) = direct.filter(|direct| direct.is_exact && direct.gap <= S::ZERO) {
        patch_along(&pair, a, certain, margin, points);
        return Ok(());
    }
    let (start, mut simplex) = begin(&pair);
    let best = nearest(&pair, start, margin, &mut simplex, proof).map_err(|apart| apart.normal)?;
    match direct.filter(|direct| direct.gap > best.gap + pair.tolerance) {
        Some(direct) => patch_along(&pair, a, direct, margin, points),
        None => patch(&pair, a, best, Some(&simplex), margin, points),
    }
    Ok(())
}

/// Returns a start direction with its gap, and the vertex along it.
#[inline(always)]
fn begin<S: Scalar>(pair: &Pair<S>) -> (Gap<S>, Simplex<S>) {
    let normal = pair.start();
    let vertex = pair.vertex(normal);
    let start = Gap {
        normal,
        gap: normal.dot(vertex.w),
        is_exact: false,
    };
    (start, Simplex::new(vertex))
}

/// Returns the largest gap between two cores, or as an error a separating one if the bodies are more than `margin`
/// apart. The simplex must be the vertex along `start` and becomes the vertices of the nearest points. `proof` becomes
/// that of the depth of overlapping polyhedra.
fn nearest<S: Scalar>(
    pair: &Pair<S>,
    start: Gap<S>,
    margin: S,
    simplex: &mut Simplex<S>,
    proof: Option<&mut DepthProof>,
) -> Result<Gap<S>, Gap<S>> {
    let radii = pair.a.radius + pair.b.radius;
    let best = match gjk(pair, start, margin + radii, simplex) {
        Cores::Apart(gap) => return Err(gap),
        Cores::Near(best) => best,
        Cores::Overlap => epa(pair, start, simplex, proof),
    };
    if best.gap - radii <= margin {
        Ok(best)
    } else {
        Err(best)
    }
}

/// Computes the contacts of one environment from a known normal, in the first shape's frame, and gap.
pub(super) fn points_along<S: Scalar>(
    (a, b): (AnyPlaced<S>, AnyPlaced<S>),
    (normal, gap): (Vec3<S>, S),
    margin: S,
    points: &mut Points<S>,
) {
    let gap = Gap {
        normal,
        gap,
        is_exact: true,
    };
    patch_along(&Pair::new(a, b), a, gap, margin, points);
}

/// Computes the contacts of a pair whose largest gap was found without a simplex.
fn patch_along<S: Scalar>(
    pair: &Pair<S>,
    a: AnyPlaced<S>,
    gap: Gap<S>,
    margin: S,
    points: &mut Points<S>,
) {
    patch(pair, a, gap, None, margin, points);
}
