//! The constraints of a lane.

use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real};
use clench_solver::Block;

/// Returns the active blocks of lane `lane`, each with its index among all blocks.
pub(super) fn active_blocks<T: Real>(
    ws: &Workspace<T>,
    lane: usize,
) -> impl Iterator<Item = (usize, Block<'_, T>)> {
    // The constraint blocks may be followed by blocks of the metric.
    let blocks = ws.problem.blocks().take(ws.record.blocks.len());
    let acts = move |&(i, _): &(usize, Block<'_, T>)| ws.record.blocks[i].active.lane(lane);
    blocks.enumerate().filter(acts)
}
