//! The interface between the solvers and the cost of a block.

use clench_math::{Mask, Real};

/// The maximum number of rows of a block: a weld, or a contact with spin and roll.
pub(crate) const MAX_DIM: usize = 6;

/// The parameters of one block, row by row; see [`BlockMut`](crate::BlockMut).
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    pub d: &'a [T],
    pub r: &'a [T],
    pub shape: &'a [T],
    /// The number added to R by a stage of [continuation](crate::continuation); used only by elliptic cones.
    pub softer: T,
    /// The normal force λ that limits the friction of a Coulomb block; see [`normal_forces`](crate::normal_forces).
    pub lambda: T,
}

/// The sums over all evaluated blocks.
#[derive(Clone, Copy)]
pub(crate) struct Totals<T: Real> {
    /// Σ s(y).
    pub cost: T,
    /// The number of entries of the active set that differ from those of the last evaluation.
    pub changes: T,
    /// The lanes in which some block is on a piece whose Hessian varies: an elliptic cone's surface.
    pub curved: T::Mask,
}

impl<T: Real> Totals<T> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Totals {
            cost: T::ZERO,
            changes: T::ZERO,
            curved: T::Mask::splat(false),
        }
    }

    /// Records the current piece of a row or edge.
    #[inline(always)]
    pub(crate) fn mark(&mut self, piece: &mut T, now: T) {
        self.changes += T::select(piece.eq(now), T::ZERO, T::ONE);
        *piece = now;
    }
}

/// The Hessian block of one cost; its [`Form`] says which entries are written.
pub(crate) type Weight<T> = [[T; MAX_DIM]; MAX_DIM];

/// The entries of a [`Weight`] that can be nonzero.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Form {
    /// None.
    Zero,
    /// The diagonal.
    Diagonal,
    /// The first row, the first column and the diagonal (row 0 and the diagonal are written).
    Arrow,
    /// All.
    Full,
}

impl Form {
    /// Returns `Diagonal` if there are nonzero entries, else `Zero`.
    #[inline(always)]
    pub(super) fn diagonal_if(nonzero: bool) -> Form {
        if nonzero { Form::Diagonal } else { Form::Zero }
    }
}

/// The growth of the derivative along a ray since its start, and the second derivative.
#[derive(Clone, Copy)]
pub(crate) struct Slope<T> {
    pub growth: T,
    pub second: T,
}

/// A change σ j jᵀ of a Hessian block, with j = J_row + factor · J_side.
#[derive(Clone, Copy)]
pub(crate) struct RankOne<T> {
    pub sigma: T,
    pub row: usize,
    pub side: Option<(usize, T)>,
}

/// The operations of a constraint's cost that Newton, CG and the line search use. (Noslip, continuation and the input
/// checks match on [`Cost`] if they need more.)
///
/// `y` is J a − aref. The active set holds the piece of its cost that each row or edge is on. A lane without the
/// constraint has D = 0: it adds nothing, and its active set never changes.
pub(crate) trait BlockCost<T: Real> {
    /// Returns the number of active-set entries of a block of `dim` rows: one for each row or edge that changes its
    /// piece independently.
    fn active_len(dim: usize) -> usize;
    /// Writes the force −∇s(y) and the active set, and adds to the totals.
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    );
    /// Writes ∇²s(y) for an up-to-date active set.
    fn hessian(rows: Rows<T>, y: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form;
    /// Calls `emit` with each rank-one change of the Hessian block from the active set `old` to `new`; no piece of
    /// either may be curved.
    fn changes(rows: Rows<T>, old: &[T], new: &[T], emit: impl FnMut(RankOne<T>));
    /// Adds the derivatives of α ↦ s(y + α dy), the first minus its value at 0. For α ≥ 0 this is a sum of nonnegative
    /// terms.
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>);
    /// Computes the Bregman divergence s(y + α dy) − s(y) − α ∇s(y)·dy ≥ 0 without cancellation.
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T;
}
