//! Islands: trees that no constraint couples are separate problems.
//!
//! Each island is copied into a compact problem of its own and solved as if nothing else existed: fewer iterations where
//! another island is hard, smaller factors, and a stop rule in its own scale. Trees on which no constraint acts are not
//! touched at all.
//!
//! Lanes have islands of their own. Those that have the same one solve it side by side, and the blocks of all other lanes
//! are absent from its problem; so it does not matter to a lane what its neighbours have. Where few lanes have an island,
//! each solves it in scalars, which is faster and gives the same bits.

use crate::partition::{Island, Lists, Partition};
use crate::problem::{Part, Problem};
use crate::results::Results;
use crate::slot::Slot;
use crate::transfer::{AllLanes, OneLane, Transfer};
use crate::{Settings, SolveClock};
use clench_math::{Mask, Real};

/// The partition, and a compact problem for each part.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands<T: Real> {
    partition: Partition<T>,
    lists: TreeLists,
    slots: Slots<T>,
    /// For islands that are solved in scalars.
    scalar: Slot<T::Scalar>,
}

/// What belongs to each tree.
#[derive(Clone, Debug, Default)]
struct TreeLists {
    dofs: Lists,
    /// The blocks whose first dof is the tree's.
    blocks: Lists,
    /// The index of each dof in the island at hand.
    local: Vec<u32>,
}

/// Memory for islands that are solved side by side.
#[derive(Clone, Debug, Default)]
struct Slots<T: Real> {
    slots: Vec<Slot<T>>,
    /// A tree that is an island by itself has a slot of its own, whose patterns stay as they are.
    single: Vec<Option<u32>>,
    /// Those of the first island of several trees, of the second and so on, and how many are taken.
    several: Vec<u32>,
    taken: usize,
}

/// A solve of all islands.
struct Job<'a, T: Real> {
    problem: &'a Problem<T>,
    settings: &'a Settings,
    warmstart: Option<&'a [T]>,
    partition: &'a Partition<T>,
    lists: &'a mut TreeLists,
    clock: &'a mut SolveClock,
    results: &'a mut Results<T>,
}

/// Whether so many lanes solve an island of so many dofs faster side by side than one after the other in scalars. With
/// AVX-512 a solve in lanes was measured to take 1.35 times as long as one in scalars for an arm and a box (12 dofs), twice
/// for a stack of five (30), 2.8 times for a tower of ten (60), 4.5 times for a pile of 200 bodies.
fn worth_lanes<T: Real>(lanes: usize, dofs: usize) -> bool {
    const MIN_LANES: usize = 2;
    const DOFS_A_LANE: usize = 48;
    const MAX_LANES: usize = 5;
    let enough = (MIN_LANES + dofs / DOFS_A_LANE).min(MAX_LANES);
    lanes >= enough.min(T::LANES)
}

impl<T: Real> Islands<T> {
    /// Finds the islands of `problem`; true if they are worth solving by parts.
    pub(crate) fn find(&mut self, problem: &Problem<T>) -> bool {
        self.partition.find(problem);
        !self.partition.is_whole()
    }

    /// Solves each island and adds it to the results.
    pub(crate) fn solve(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
        clock: &mut SolveClock,
        results: &mut Results<T>,
    ) {
        self.lists.fill(problem);
        self.slots.start(problem.tree().ntree());
        let mut job = Job {
            problem,
            settings,
            warmstart,
            partition: &self.partition,
            lists: &mut self.lists,
            clock,
            results,
        };
        for island in self.partition.islands() {
            let dofs = job.lists.count_dofs(self.partition.trees(island));
            if worth_lanes::<T>(island.lanes.count(), dofs) {
                let slot = self.slots.slot(self.partition.trees(island));
                job.solve(island, island.lanes, slot, AllLanes);
                continue;
            }
            for k in (0..T::LANES).filter(|&k| island.lanes.lane(k)) {
                let mut lane = T::Mask::splat(false);
                lane.set_lane(k, true);
                job.solve(island, lane, &mut self.scalar, OneLane(k));
            }
        }
    }
}

impl<T: Real> Job<'_, T> {
    /// Solves an island for some of the lanes that have it.
    fn solve<F: Real>(
        &mut self,
        island: &Island<T>,
        lanes: T::Mask,
        slot: &mut Slot<F>,
        transfer: impl Transfer<T, F>,
    ) {
        self.gather(island, lanes, slot, transfer);
        let warmstart = self.warmstart.map(|warm| {
            slot.warmstart.clear();
            let dofs = slot.dofs.iter().map(|&dof| dof as usize);
            (slot.warmstart).extend(dofs.map(|dof| transfer.take(warm[dof])));
            &slot.warmstart[..]
        });
        std::mem::swap(&mut slot.work.state.clock, self.clock);
        slot.work.run(&slot.problem, self.settings, warmstart);
        std::mem::swap(&mut slot.work.state.clock, self.clock);
        let acting = self.partition.acting();
        (self.results).add(self.problem, slot, lanes, acting, transfer);
    }

    /// Copies the dofs and blocks of an island into a slot.
    fn gather<F: Real>(
        &mut self,
        island: &Island<T>,
        lanes: T::Mask,
        slot: &mut Slot<F>,
        transfer: impl Transfer<T, F>,
    ) {
        let acting = self.partition.acting();
        slot.dofs.clear();
        slot.blocks.clear();
        for &tree in self.partition.trees(island) {
            slot.dofs.extend(self.lists.dofs.iter(tree));
            let blocks = self.lists.blocks.iter(tree);
            (slot.blocks).extend(blocks.filter(|&k| (acting[k as usize] & lanes).any()));
        }
        slot.blocks.sort_unstable();
        if self.partition.is_ascending(island) {
            // The dofs of two trees may alternate.
            slot.dofs.sort_unstable();
        }
        for (local, &dof) in slot.dofs.iter().enumerate() {
            self.lists.local[dof as usize] = local as u32;
        }
        let part = Part {
            dofs: &slot.dofs,
            local: &self.lists.local,
            blocks: &slot.blocks,
            acting,
            lanes,
        };
        slot.problem.gather(self.problem, &part, transfer);
    }
}

impl TreeLists {
    /// Lists the dofs and blocks of each tree, ascending.
    fn fill<T: Real>(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        self.local.resize(tree.nv(), 0);
        self.dofs.clear(tree.ntree());
        for dof in (0..tree.nv()).rev() {
            self.dofs.push_front(tree.tree_of(dof) as u32, dof as u32);
        }
        self.blocks.clear(tree.ntree());
        for k in (0..problem.nblock()).rev() {
            if let Some(&dof) = problem.block(k).dofs.first() {
                (self.blocks).push_front(tree.tree_of(dof as usize) as u32, k as u32);
            }
        }
    }

    fn count_dofs(&self, trees: &[u32]) -> usize {
        trees.iter().map(|&t| self.dofs.iter(t).count()).sum()
    }
}

impl<T: Real> Slots<T> {
    /// Gives out all slots anew.
    fn start(&mut self, trees: usize) {
        self.single.resize(trees, None);
        self.taken = 0;
    }

    /// The slot of the next island.
    fn slot(&mut self, trees: &[u32]) -> &mut Slot<T> {
        let new = self.slots.len() as u32;
        let slot = match *trees {
            [tree] => *self.single[tree as usize].get_or_insert(new),
            _ => {
                self.taken += 1;
                if self.several.len() < self.taken {
                    self.several.push(new);
                }
                self.several[self.taken - 1]
            }
        };
        if slot == new {
            self.slots.push(Slot::default());
        }
        &mut self.slots[slot as usize]
    }
}
