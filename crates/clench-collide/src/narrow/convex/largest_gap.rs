//! The largest gap among a few directions.

use clench_math::{Scalar, Vec3};

/// The largest gap so far, and its direction.
pub(super) struct LargestGap<S> {
    pub gap: S,
    pub normal: Vec3<S>,
    /// What the gap along an exact direction must exceed: between equals, to the tolerance, the first one is kept.
    bar: S,
    tolerance: S,
}

impl<S: Scalar> LargestGap<S> {
    /// No gap as yet, and any direction.
    pub(super) fn new(tolerance: S) -> Self {
        LargestGap {
            gap: -S::INFINITY,
            normal: Vec3::new(S::ZERO, S::ZERO, S::ONE),
            bar: -S::INFINITY,
            tolerance,
        }
    }

    /// Takes a better direction.
    #[inline]
    pub(super) fn offer(&mut self, gap: S, normal: impl FnOnce() -> Vec3<S>) {
        if gap > self.bar {
            (self.gap, self.normal) = (gap, normal());
            self.bar = gap + self.tolerance;
        }
    }

    /// The penetration depth that another direction must undercut to be taken.
    #[inline]
    pub(super) fn depth(&self) -> S {
        (-self.bar).max(S::ZERO)
    }
}
