//! The results of a solve.

use crate::iterate::all_finite;
use crate::problem::Problem;
use crate::slot::Slot;
use crate::stats::{SolveStats, Status};
use crate::transfer::Transfer;
use crate::workspace::Workspace;
use clench_math::{Real, kernel};

/// The results of a solve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results<T: Real> {
    pub qacc: Vec<T>,
    pub force: Vec<T>,
    /// Edge forces of pyramids, at the index of their entries in the active set.
    pub edges: Vec<T>,
    pub qfrc_constraint: Vec<T>,
    pub stats: SolveStats<T>,
}

impl<T: Real> Results<T> {
    /// Sets the results of a problem in which no constraint acts.
    #[kernel]
    pub fn reset(&mut self, problem: &Problem<T>) {
        let finite = all_finite(&problem.qacc_smooth);
        let status = T::select(
            finite,
            Status::Unconstrained.code(),
            Status::NonFinite.code(),
        );
        self.stats = SolveStats {
            status,
            ..SolveStats::default()
        };
        copy(&mut self.qacc, &problem.qacc_smooth);
        for (v, len) in [
            (&mut self.force, problem.nrow()),
            (&mut self.edges, problem.nactive),
            (&mut self.qfrc_constraint, problem.nv()),
        ] {
            v.clear();
            v.resize(len, T::ZERO);
        }
    }

    /// Copies the results of a problem that was solved as a whole.
    pub(crate) fn set(&mut self, work: &Workspace<T>) {
        let iterate = &work.state.iterate;
        self.stats = work.state.stats;
        copy(&mut self.qacc, &iterate.qacc);
        copy(&mut self.force, &iterate.force);
        copy(&mut self.edges, &work.edges);
        copy(&mut self.qfrc_constraint, &iterate.qfrc_constraint);
    }

    /// Adds the results of an island of `problem` in `lanes`; `acting` holds the lanes in which each block acts.
    #[kernel]
    pub fn add<F: Real>(
        &mut self,
        problem: &Problem<T>,
        island: &Slot<F>,
        lanes: T::Mask,
        acting: &[T::Mask],
        transfer: impl Transfer<T, F>,
    ) {
        let iterate = &island.work.state.iterate;
        self.stats
            .combine(&island.work.state.stats, lanes, transfer);
        for (local, &dof) in island.dofs.iter().enumerate() {
            let dof = dof as usize;
            blend(
                lanes,
                &mut self.qacc[dof],
                transfer.convert_back(iterate.qacc[local]),
            );
            let force = transfer.convert_back(iterate.qfrc_constraint[local]);
            blend(lanes, &mut self.qfrc_constraint[dof], force);
        }
        for (b, &k) in island.problem.jacobian.blocks.iter().zip(&island.blocks) {
            let to = &problem.jacobian.blocks[k as usize];
            let lanes = lanes & acting[k as usize];
            let force = &iterate.force[b.rows()];
            for (to, &from) in self.force[to.rows()].iter_mut().zip(force) {
                blend(lanes, to, transfer.convert_back(from));
            }
            let edges = &island.work.edges[b.active_range()];
            for (to, &from) in self.edges[to.active_range()].iter_mut().zip(edges) {
                blend(lanes, to, transfer.convert_back(from));
            }
        }
    }
}

fn copy<T: Copy>(to: &mut Vec<T>, from: &[T]) {
    to.clear();
    to.extend_from_slice(from);
}

/// Copies `from` in the lanes of `mask`.
#[inline(always)]
fn blend<T: Real>(mask: T::Mask, to: &mut T, from: T) {
    *to = T::select(mask, from, *to);
}
