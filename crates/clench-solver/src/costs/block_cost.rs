//! What the solvers ask of the cost of a block, and in what terms it answers.

use clench_math::{Mask, Real};

/// Most rows of a block: a weld, or a contact with spin and roll.
pub(crate) const MAX_DIM: usize = 6;

/// The parameters of one block, row by row; see [`BlockMut`](crate::BlockMut).
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    pub d: &'a [T],
    pub r: &'a [T],
    pub shape: &'a [T],
    /// Added to R by a stage of [continuation](crate::continuation); only elliptic cones heed it.
    pub softer: T,
}

/// What evaluating the blocks adds up to.
#[derive(Clone, Copy)]
pub(crate) struct Totals<T: Real> {
    /// Σ s(y).
    pub cost: T,
    /// Entries of the active set that differ from those of the last evaluation.
    pub changes: T,
    /// Where some block is on a piece whose Hessian varies: an elliptic cone's surface.
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

    /// Records the piece that a row or edge is on now.
    #[inline(always)]
    pub(crate) fn mark(&mut self, piece: &mut T, now: T) {
        self.changes += T::select(piece.eq(now), T::ZERO, T::ONE);
        *piece = now;
    }
}

/// The Hessian block of one cost, as far as its [`Form`] says it is written.
pub(crate) type Weight<T> = [[T; MAX_DIM]; MAX_DIM];

/// Which entries of a [`Weight`] can be nonzero.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Form {
    /// None.
    Zero,
    /// The diagonal.
    Diagonal,
    /// First row, first column, diagonal (row 0 and the diagonal are written).
    Arrow,
    /// All.
    Full,
}

impl Form {
    /// A diagonal with nonzero entries, or nothing.
    #[inline(always)]
    pub(super) fn diagonal_if(nonzero: bool) -> Form {
        if nonzero { Form::Diagonal } else { Form::Zero }
    }
}

/// By how much the derivative along a ray has grown since its start, and the second derivative.
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

/// What Newton, CG and the line search ask of a constraint's cost. (Noslip, continuation and the checks of input match on
/// [`Cost`] where they need more.)
///
/// `y` is J a − aref. The active set says which piece of its cost each row or edge is on. A lane without the constraint has D = 0: it adds
/// nothing, and its active set never changes.
pub(crate) trait BlockCost<T: Real> {
    /// How many entries of the active set a block of `dim` rows has: one for each row or edge that changes its piece on its own.
    fn active_len(dim: usize) -> usize;
    /// Writes the force −∇s(y) and the active set, and adds to the totals.
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    );
    /// Writes ∇²s(y), whose active set is known.
    fn hessian(rows: Rows<T>, y: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form;
    /// Calls `emit` with each rank-one change of the Hessian block from the active set `old` to `new`; no piece of either may be
    /// curved.
    fn changes(rows: Rows<T>, old: &[T], new: &[T], emit: impl FnMut(RankOne<T>));
    /// Adds the derivatives of α ↦ s(y + α dy), the first less what it is at 0: for α ≥ 0 a sum of terms that are not negative.
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>);
    /// The Bregman divergence s(y + α dy) − s(y) − α ∇s(y)·dy ≥ 0, without the cancellation of subtracting values.
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T;
}
