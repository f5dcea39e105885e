//! Sensors of joint and tendon limits.

use super::read::Reading;
use clench_dynamics::constraint::ConstraintSource;
use clench_math::{Mask, Real, kernel};

/// The row of a limit; zero if the limit is inactive.
pub(super) struct LimitReading<T> {
    /// Distance to the limit minus the margin.
    pub pos: T,
    /// Its rate of change.
    pub vel: T,
    /// The limit's force.
    pub force: T,
}

impl<T: Real> Reading<'_, T> {
    /// Returns the first active limit of a joint or tendon.
    #[kernel]
    pub(super) fn limit(&self, source: ConstraintSource) -> LimitReading<T> {
        let ws = self.ws;
        let mut limit = LimitReading {
            pos: T::ZERO,
            vel: T::ZERO,
            force: T::ZERO,
        };
        let mut found = T::Mask::splat(false);
        for (block, record) in ws.record.blocks.iter().enumerate() {
            let first = record.active & !found;
            if record.source != source || !first.any() {
                continue;
            }
            let row = ws.problem.block(block).row;
            limit.pos = T::select(first, ws.record.pos[row] - record.margin, limit.pos);
            limit.vel = T::select(first, ws.record.vel[row], limit.vel);
            limit.force = T::select(first, ws.solver.force()[row], limit.force);
            found |= first;
        }
        limit
    }
}
