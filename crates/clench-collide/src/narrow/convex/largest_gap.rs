//! The largest gap among a few directions.

use clench_math::{Scalar, Vec3};

/// The largest gap found and its direction.
pub(super) struct LargestGap<S> {
    pub gap: S,
    pub normal: Vec3<S>,
    /// The minimum for another gap: of gaps equal to the tolerance, the first is kept.
    bar: S,
    tolerance: S,
}

impl<S: Scalar> LargestGap<S> {
    /// Starts without a gap, with an arbitrary direction.
    pub(super) fn new(tolerance: S) -> Self {
        LargestGap {
            gap: -S::INFINITY,
            normal: Vec3::new(S::ZERO, S::ZERO, S::ONE),
            bar: -S::INFINITY,
            tolerance,
        }
    }

    /// Keeps the direction if its gap is larger.
    #[inline]
    pub(super) fn offer(&mut self, gap: S, normal: impl FnOnce() -> Vec3<S>) {
        if gap > self.bar {
            (self.gap, self.normal) = (gap, normal());
            self.bar = gap + self.tolerance;
        }
    }

    /// Returns the penetration depth that another direction must undercut.
    #[inline]
    pub(super) fn depth(&self) -> S {
        (-self.bar).max(S::ZERO)
    }
}
