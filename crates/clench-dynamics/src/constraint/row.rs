//! One row of a block, before the block is pushed.

use super::softness::Softness;
use clench_math::Real;

/// One row of a block: everything but its Jacobian.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row<T> {
    /// Position.
    pub pos: T,
    /// Part of the reference acceleration that does not depend on the row's velocity.
    pub aref: T,
    /// Damping b: the rest of the reference acceleration is −b v.
    pub damping: T,
    /// Stiffness k d, of which steps that take the spring at their end need more than `aref`.
    pub stiffness: T,
    /// Regularization.
    pub r: T,
    /// The part of its velocity that is not J v: that of surfaces which move by themselves.
    pub drift: T,
    /// A force with which the row pulls where it would otherwise give none: the reference acceleration is raised by R times this.
    pub pull: T,
    /// Shape of its cost, see `clench_solver::BlockMut::shape`.
    pub shape: T,
}

impl<T: Real> Row<T> {
    /// A row at `pos` that is violated by `r = pos − margin` and sees the inverse inertia `a0`.
    #[inline(always)]
    pub(super) fn new(soft: &Softness<T>, pos: T, margin: T, a0: T) -> Self {
        Row {
            pos,
            aref: -soft.stiffness * (pos - margin),
            damping: soft.damping,
            stiffness: soft.stiffness,
            r: soft.regularization(a0),
            drift: T::ZERO,
            pull: T::ZERO,
            shape: T::ZERO,
        }
    }
}
