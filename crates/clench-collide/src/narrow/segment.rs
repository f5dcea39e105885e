//! The axis segment of a capsule.

use super::placed::Placed;
use crate::shape::Capsule;
use clench_math::{Real, Vec3};

/// The points center + t axis with |t| ≤ half length.
#[derive(Clone, Copy)]
pub(super) struct Segment<T> {
    pub center: Vec3<T>,
    /// The unit direction.
    pub axis: Vec3<T>,
    pub half_length: T,
}

impl<T: Real> Segment<T> {
    /// Returns the axis segment of a capsule, in world coordinates.
    #[inline(always)]
    pub(super) fn of(capsule: Placed<Capsule<T>, T>) -> Self {
        Segment {
            center: capsule.pose.position,
            axis: capsule.pose.axis(),
            half_length: capsule.shape.half_length,
        }
    }
    /// Returns the point at a signed length from the middle.
    #[inline(always)]
    pub(super) fn at(&self, t: T) -> Vec3<T> {
        self.center + self.axis * t
    }
    /// Returns the nearest parameter on the segment.
    #[inline(always)]
    pub(super) fn clamp(&self, t: T) -> T {
        t.clamp(-self.half_length, self.half_length)
    }
}
