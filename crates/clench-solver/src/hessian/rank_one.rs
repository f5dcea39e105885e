//! The vector of a rank-one change of the Hessian.

use crate::block_index::BlockIndex;
use crate::costs::RankOne;
use crate::problem::Problem;
use clench_math::Real;

/// Calls `put` with each entry of the vector of a rank-one change of a block's Hessian.
#[inline(always)]
pub(super) fn each_of_change<T: Real>(
    problem: &Problem<T>,
    b: &BlockIndex,
    change: &RankOne<T>,
    mut put: impl FnMut(usize, T),
) {
    let (dofs, values) = (problem.jacobian.dofs(b), problem.jacobian.values(b));
    let row = |i: usize| &values[i * b.ndof..(i + 1) * b.ndof];
    for (k, &dof) in dofs.iter().enumerate() {
        let side = change
            .side
            .map_or(T::ZERO, |(side, factor)| factor * row(side)[k]);
        put(dof as usize, row(change.row)[k] + side);
    }
}
