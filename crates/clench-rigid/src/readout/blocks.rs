//! The constraints of a lane.

use crate::workspace::Workspace;
use clench_math::{Mask, Real};
use clench_solver::Block;

/// The blocks that act in lane `lane`, each with its place among all.
pub(super) fn active_blocks<T: Real>(
    ws: &Workspace<T>,
    lane: usize,
) -> impl Iterator<Item = (usize, Block<'_, T>)> {
    let blocks = ws.problem.blocks().enumerate();
    blocks.filter(move |&(i, _)| ws.record.blocks[i].active.lane(lane))
}
