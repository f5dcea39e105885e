//! What collision finds: contact points, in a small buffer without heap.

use crate::frame_from_normal;
use clench_math::{Mask, Mat3, Real, Vec3};

/// The most points that one pair yields: something on a height field, which may touch it in many places.
pub const MAX_POINTS: usize = 32;
/// The most points that two convex shapes yield: a face of a box on a face of another.
pub const PATCH_POINTS: usize = 8;

/// One point where two shapes touch or are about to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint<T: Real> {
    /// Midway between the two surfaces, in world coordinates, m.
    pub position: Vec3<T>,
    /// Rows: the unit normal from the first shape to the second, then two tangents.
    pub frame: Mat3<T>,
    /// Distance between the surfaces along the normal, m; negative where they penetrate.
    pub distance: T,
    /// In which environments the point exists. Elsewhere the other fields are finite (if poses and sizes are) and
    /// mean nothing.
    pub active: T::Mask,
}

impl<T: Real> ContactPoint<T> {
    /// A point that exists nowhere.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        ContactPoint {
            position: Vec3::ZERO,
            frame: Mat3::IDENTITY,
            distance: T::ZERO,
            active: T::Mask::splat(false),
        }
    }
    /// A point whose tangents follow from its normal.
    #[inline(always)]
    pub(crate) fn new(position: Vec3<T>, normal: Vec3<T>, distance: T, active: T::Mask) -> Self {
        ContactPoint {
            position,
            frame: frame_from_normal(normal),
            distance,
            active,
        }
    }
}

/// The contact points of one pair: at most [`PATCH_POINTS`], with a height field at most [`MAX_POINTS`].
#[derive(Clone, Copy, Debug)]
pub struct Contacts<T: Real> {
    points: [ContactPoint<T>; MAX_POINTS],
    len: usize,
}

impl<T: Real> Contacts<T> {
    /// No points.
    #[inline(always)]
    pub fn new() -> Self {
        Contacts {
            points: [ContactPoint::none(); MAX_POINTS],
            len: 0,
        }
    }
    /// Forgets all points.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }
    /// The points found, each active in at least one environment. In every environment its points come in the same
    /// order as if it were alone.
    #[inline(always)]
    pub fn as_slice(&self) -> &[ContactPoint<T>] {
        &self.points[..self.len]
    }
    /// Leaves each environment the first of its deepest points.
    #[inline(always)]
    pub fn keep_deepest(&mut self) {
        if self.len < 2 {
            return;
        }
        let mut deepest = self.points[0];
        for point in &self.points[1..self.len] {
            let first = point.active & !deepest.active;
            let deeper = point.active & point.distance.lt(deepest.distance);
            let taken = first | deeper;
            deepest = ContactPoint {
                position: Vec3::select(taken, point.position, deepest.position),
                frame: Mat3::select(taken, point.frame, deepest.frame),
                distance: T::select(taken, point.distance, deepest.distance),
                active: deepest.active | point.active,
            };
        }
        self.points[0] = deepest;
        self.len = 1;
    }
    /// The point at `place`, which may be that after the last: there a point is added, which exists nowhere yet.
    #[inline(always)]
    pub(crate) fn slot(&mut self, place: usize) -> &mut ContactPoint<T> {
        if place == self.len {
            self.points[place] = ContactPoint::none();
            self.len += 1;
        }
        &mut self.points[place]
    }
    /// Adds a point if any environment has it. No pair has more points than there is room for.
    #[inline(always)]
    pub(crate) fn push(&mut self, point: ContactPoint<T>) {
        debug_assert!(self.len < MAX_POINTS);
        if point.active.any() && self.len < MAX_POINTS {
            self.points[self.len] = point;
            self.len += 1;
        }
    }
}

impl<T: Real> Default for Contacts<T> {
    #[inline(always)]
    fn default() -> Self {
        Contacts::new()
    }
}
