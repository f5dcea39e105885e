//! Broad phase: which pairs of shapes are near enough to be worth asking about.

use crate::Pose;
use clench_math::{Mask, Real};

/// What the broad phase knows of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<T> {
    /// Radius of a sphere about the shape's origin that holds it, m ([`bounding_radius`](crate::bounding_radius)).
    pub radius: T,
    /// Whether it is a plane, which no sphere holds.
    pub plane: bool,
}

/// Two shapes that may collide, the first of no higher kind than the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<T: Real> {
    /// Index of the first shape.
    pub first: u32,
    /// Index of the second shape.
    pub second: u32,
    /// Points up to this distance are wanted, m.
    pub margin: T::Scalar,
}

/// In which environments two shapes are near enough that they may be within `margin` of each other.
#[inline(always)]
pub fn near<T: Real>(
    a: &Bound<T>,
    pose_a: &Pose<T>,
    b: &Bound<T>,
    pose_b: &Pose<T>,
    margin: T,
) -> T::Mask {
    let offset = pose_b.position - pose_a.position;
    match (a.plane, b.plane) {
        (false, false) => {
            let reach = a.radius + b.radius + margin;
            offset.norm_squared().le(reach * reach)
        }
        (true, false) => pose_a.axis().dot(offset).le(b.radius + margin),
        (false, true) => (-pose_b.axis().dot(offset)).le(a.radius + margin),
        (true, true) => T::Mask::splat(false),
    }
}

/// Replaces `hits` by the indices, ascending, of those `pairs` that are [`near`] in any environment.
pub fn listed<T: Real>(
    bounds: &[Bound<T>],
    poses: &[Pose<T>],
    pairs: &[Pair<T>],
    hits: &mut Vec<u32>,
) {
    hits.clear();
    for (index, pair) in pairs.iter().enumerate() {
        let (a, b) = (pair.first as usize, pair.second as usize);
        let margin = T::splat(pair.margin);
        if near(&bounds[a], &poses[a], &bounds[b], &poses[b], margin).any() {
            hits.push(index as u32);
        }
    }
}

/// Sweep and prune for scenes of many shapes, where listing all pairs would be too many.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    order: Vec<(f64, u32)>,
}

impl Sweep {
    /// An empty sweep; its buffers grow to the largest scene seen.
    pub fn new() -> Self {
        Sweep::default()
    }
    /// Replaces `pairs` by those (i, j), i < j, ascending, that `allowed` admits and that are within
    /// `margins[i] + margins[j]` of being [`near`] in any environment.
    pub fn pairs<T: Real>(
        &mut self,
        bounds: &[Bound<T>],
        poses: &[Pose<T>],
        margins: &[T],
        mut allowed: impl FnMut(u32, u32) -> bool,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        self.order.clear();
        pairs.clear();
        for j in 0..bounds.len() {
            for i in 0..j {
                let margin = margins[i] + margins[j];
                if allowed(i as u32, j as u32)
                    && near(&bounds[i], &poses[i], &bounds[j], &poses[j], margin).any()
                {
                    pairs.push((i as u32, j as u32));
                }
            }
        }
        pairs.sort_unstable();
    }
}
