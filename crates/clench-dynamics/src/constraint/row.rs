//! One row of a block, with the spring's part of its reference acceleration.

use super::softness::Softness;
use clench_math::Real;

/// One row of a block without its Jacobian.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row<T> {
    /// The position; of friction that sticks, the displacement.
    pub pos: T,
    /// The part of the reference acceleration that does not depend on the row's velocity.
    pub aref: T,
    /// The damping b: the remaining reference acceleration is −b v.
    pub damping: T,
    /// The stiffness k d, which steps that evaluate the spring at their end need in addition to `aref`.
    pub stiffness: T,
    /// The regularization.
    pub r: T,
    /// The part of the velocity that is not J v: the surfaces' own velocity.
    pub drift: T,
    /// The adhesive force of the row: raises the reference acceleration by R times this.
    pub pull: T,
    /// The shape of the cost, see `clench_solver::BlockMut::shape`.
    pub shape: T,
}

impl<T: Real> Row<T> {
    /// Creates a row at `pos` with violation `r = pos − margin` and inverse inertia `a0`.
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

    /// Returns the reference acceleration at a velocity of the row, without that of adhesion.
    #[inline(always)]
    pub(super) fn at_velocity(&self, velocity: T) -> T {
        self.aref - self.damping * velocity
    }
}
