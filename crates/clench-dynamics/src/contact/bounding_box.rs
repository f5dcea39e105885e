//! Axis-aligned bounding boxes of two geoms: a test that takes a quarter of the time in which the narrow phase finds
//! most near pairs apart.

use super::Candidate;
use super::placed_shape::shape;
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{ShapeKind, allowance};
use clench_math::{Mask, Real, kernel};

/// Returns true if the test pays for a pair: both geoms have boxes, and the narrow phase is more than a few operations.
#[inline(always)]
pub(super) fn pays(candidate: &Candidate) -> bool {
    let [first, second] = candidate.kinds;
    first > ShapeKind::HeightField && second > ShapeKind::Capsule
}

/// Returns the lanes in which boxes about two geoms are at most `range` apart along every coordinate axis.
#[kernel]
pub(super) fn boxes_may_touch<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    candidate: &Candidate,
    range: T,
) -> T::Mask {
    let mut reach = [range.max(range * allowance()); 3];
    let [a, b] = candidate.geoms.map(|g| g as usize);
    for geom in [a, b] {
        // The boxes about the geoms' own boxes.
        let half = shape(model, params, geom).half_lengths() * allowance();
        for (reach, row) in reach.iter_mut().zip(&pos.geom_xmat[geom].rows) {
            *reach += row.x.abs() * half.x + row.y.abs() * half.y + row.z.abs() * half.z;
        }
    }
    let offset = (pos.geom_xpos[b] - pos.geom_xpos[a]).to_array();
    let mut near = T::Mask::splat(true);
    for (offset, reach) in offset.into_iter().zip(reach) {
        near &= offset.abs().le(reach);
    }
    near
}
