//! Contact points, in a buffer of fixed size.

use crate::frame::frame_from_normal;
use clench_math::{Mask, Mat3, Real, Vec3};

/// The maximum number of contact points of a pair, reached by a shape on a height field.
pub const MAX_POINTS: usize = 32;
/// The maximum number of contact points of two convex shapes, reached by two box faces.
pub const PATCH_POINTS: usize = 8;

/// A point where two shapes touch or are about to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint<T: Real> {
    /// The point midway between the two surfaces, in world coordinates, m.
    pub position: Vec3<T>,
    /// The contact frame. Rows: the unit normal from the first shape to the second, then two tangents.
    pub frame: Mat3<T>,
    /// The distance between the surfaces along the normal, m; negative where they penetrate.
    pub distance: T,
    /// The environments in which the point exists. Elsewhere the other fields are meaningless, but finite if poses and
    /// sizes are.
    pub active: T::Mask,
}

impl<T: Real> ContactPoint<T> {
    /// Returns a point that exists in no environment.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        ContactPoint {
            position: Vec3::ZERO,
            frame: Mat3::IDENTITY,
            distance: T::ZERO,
            active: T::Mask::splat(false),
        }
    }
    /// Creates a point and computes its tangents from its normal.
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

/// The contact points of a pair: at most [`PATCH_POINTS`], or [`MAX_POINTS`] with a height field.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<T: Real> {
    points: [ContactPoint<T>; MAX_POINTS],
    len: usize,
}

impl<T: Real> Contacts<T> {
    /// Creates an empty buffer.
    #[inline(always)]
    pub fn new() -> Self {
        Contacts {
            points: [ContactPoint::none(); MAX_POINTS],
            len: 0,
        }
    }
    /// Removes all points.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }
    /// Returns the points, each active in at least one environment. Their order in an environment does not depend on
    /// the others.
    #[inline(always)]
    pub fn as_slice(&self) -> &[ContactPoint<T>] {
        &self.points[..self.len]
    }
    /// Retains the first of the deepest points of each environment.
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
    /// Adds the points of some environments, after removing all points if `first`. Each environment keeps the order of
    /// its points.
    #[inline(never)]
    pub fn merge(&mut self, other: &Contacts<T>, environments: T::Mask, first: bool) {
        if first {
            self.clear();
        }
        for (index, point) in other.as_slice().iter().enumerate() {
            let (taken, slot) = (point.active & environments, self.slot(index));
            for lane in (0..T::LANES).filter(|&lane| taken.lane(lane)) {
                set_lane(&mut slot.position, lane, point.position.lane(lane));
                for (row, new) in slot.frame.rows.iter_mut().zip(&point.frame.rows) {
                    set_lane(row, lane, new.lane(lane));
                }
                slot.distance.set_lane(lane, point.distance.lane(lane));
                slot.active.set_lane(lane, true);
            }
        }
    }
    /// Returns the point at index `index`. At the end it first appends a point that exists in no environment.
    #[inline(always)]
    pub(crate) fn slot(&mut self, index: usize) -> &mut ContactPoint<T> {
        if index == self.len {
            self.points[index] = ContactPoint::none();
            self.len += 1;
        }
        &mut self.points[index]
    }
    /// Adds a point that is active in any environment. No pair exceeds the capacity.
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

/// Replaces a lane of a vector.
pub(crate) fn set_lane<T: Real>(v: &mut Vec3<T>, lane: usize, value: Vec3<T::Scalar>) {
    v.x.set_lane(lane, value.x);
    v.y.set_lane(lane, value.y);
    v.z.set_lane(lane, value.z);
}
