//! The proofs of the depths of overlapping polyhedra in earlier steps.
//!
//! Like a separating axis, a proof saves a search and changes no result. It is large, so only pairs that touch have
//! one. Pairs and environments may compete for an entry.

use super::separating_axes::hash;
use clench_collide::{DepthProof, LaneProofs, ShapeKind};

/// The number of entries per touching pair of an environment.
const ENTRIES_PER_PAIR: usize = 2;
/// The maximum number of entries, about 12 MB.
const MAX_ENTRIES: usize = 1 << 16;

/// A table of proofs.
#[derive(Clone, Debug, Default)]
pub(super) struct DepthProofs {
    proofs: Vec<DepthProof>,
    /// The environments of the lanes; empty if there is one environment.
    envs: Vec<u32>,
    /// The number of environments.
    count: usize,
    /// The number of pairs that touched since the last call of `begin`.
    touching: usize,
}

/// Returns true if the depth of a pair is searched for by polytopes of corners.
pub(super) fn applies([a, b]: [ShapeKind; 2]) -> bool {
    b == ShapeKind::Mesh && matches!(a, ShapeKind::Capsule | ShapeKind::Box | ShapeKind::Mesh)
}

impl DepthProofs {
    /// Starts a check of pairs of some environments, with capacity for as many as touched in the last one. If the table
    /// grows, all proofs are cleared.
    pub(super) fn begin(&mut self, envs: &[u32]) {
        self.envs.clear();
        self.envs.extend_from_slice(envs);
        let last = envs.iter().map(|&env| env as usize);
        self.count = last.fold(self.count, usize::max).max(1);
        let wanted = self.touching * (self.count + 1) * ENTRIES_PER_PAIR;
        let entries = wanted.next_power_of_two().min(MAX_ENTRIES);
        if self.touching > 0 && self.proofs.len() < entries {
            self.proofs.clear();
            self.proofs.resize_with(entries, DepthProof::default);
        }
        self.touching = 0;
    }

    /// Counts a pair that touches.
    pub(super) fn count_touching(&mut self) {
        self.touching += 1;
    }

    /// Returns the proofs of a pair of geoms; none before the first pair has touched.
    #[inline(always)]
    pub(super) fn of(&mut self, kinds: [ShapeKind; 2], geoms: [u32; 2]) -> LaneProofs<'_> {
        let table = match applies(kinds) {
            true => &mut self.proofs[..],
            false => &mut [],
        };
        LaneProofs::new(table, hash(geoms), &self.envs)
    }
}
