//! Islands: trees that no constraint couples are solved as separate problems.
//!
//! Each island is copied into a compact problem and solved independently: fewer iterations if another island is hard,
//! smaller factors, and a stopping rule in its own scale. Trees on which no constraint acts are not processed at all.
//!
//! Each lane has its own islands. Lanes with the same island solve it in parallel, and its problem omits the blocks of
//! all other lanes, so neighbours do not affect a lane's result. If few lanes have an island, each solves it in
//! scalars, which is faster and gives the same bits.

use crate::options::Settings;
use crate::partition::{Island, Lists, Partition};
use crate::problem::{Part, Problem};
use crate::results::Results;
use crate::slot::Slot;
use crate::stopwatch::SolveClock;
use crate::threads::Threads;
use crate::transfer::{AllLanes, OneLane, Transfer};
use crate::tree::Tree;
use clench_math::{Mask, Real};
use std::sync::Arc;

/// The partition, and a compact problem for each part.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands<T: Real> {
    partition: Partition<T>,
    lists: TreeLists,
    slots: Slots<T>,
    /// For islands solved in scalars.
    scalar: Slot<T::Scalar>,
}

/// The dofs and blocks of each tree.
#[derive(Clone, Debug, Default)]
struct TreeLists {
    dofs: Lists,
    /// The blocks whose first dof is in the tree.
    blocks: Lists,
    /// The index of each dof in the last listed island that contains it.
    local: Vec<u32>,
}

/// Memory for islands.
#[derive(Clone, Debug, Default)]
struct Slots<T: Real> {
    slots: Vec<Slot<T>>,
    /// The slot of each tree that has formed an island by itself. Trees of one shape that are solved one after the
    /// other share the slot of the first: its patterns do not change, and it stays in the processor's caches.
    single: Vec<Option<u32>>,
    /// For each tree, the first one of the same shape.
    same_shape: Vec<u32>,
    /// The forest that `single` and `same_shape` refer to.
    tree: Option<Arc<Tree>>,
    /// The slots of islands of several trees, in order, and the number in use.
    several: Vec<u32>,
    several_in_use: usize,
}

/// The inputs of a solve of all islands.
pub(crate) struct Job<'a, T: Real> {
    pub problem: &'a Problem<T>,
    pub settings: &'a Settings,
    pub warmstart: Option<&'a [T]>,
    pub threads: &'a Threads,
}

/// Returns true if `lanes` lanes solve an island of `dofs` dofs faster in parallel than one after the other in scalars.
/// Measured with AVX-512, a solve in lanes takes 1.35 times as long as one in scalars for an arm and a box (12 dofs),
/// twice for a stack of five (30), 2.8 times for a tower of ten (60), 4.5 times for a pile of 200 bodies.
fn worth_lanes<T: Real>(lanes: usize, dofs: usize) -> bool {
    const MIN_LANES: usize = 2;
    const DOFS_A_LANE: usize = 48;
    const MAX_LANES: usize = 5;
    let enough = (MIN_LANES + dofs / DOFS_A_LANE).min(MAX_LANES);
    lanes >= enough.min(T::LANES)
}

impl<T: Real> Islands<T> {
    /// Computes the islands of `problem`. Returns true if solving them separately pays.
    pub(crate) fn find(&mut self, problem: &Problem<T>) -> bool {
        self.partition.find(problem);
        !self.partition.is_whole()
    }

    /// Solves each island and adds it to the results.
    pub(crate) fn solve(&mut self, job: &Job<T>, clock: &mut SolveClock, results: &mut Results<T>) {
        if self.slots.start(&job.problem.tree) {
            self.lists.list_dofs(&job.problem.tree);
        }
        self.lists.list_blocks(job.problem);
        if T::LANES == 1 && job.threads.count() > 1 {
            self.solve_at_once(job, clock, results);
        } else {
            self.solve_in_turn(job, clock, results);
        }
    }

    /// Solves the islands of a single environment, which share no dof, on all threads.
    fn solve_at_once(&mut self, job: &Job<T>, clock: &mut SolveClock, results: &mut Results<T>) {
        let (partition, lists, slots) = (&self.partition, &mut self.lists, &mut self.slots);
        for island in partition.islands() {
            let slot = slots.take_own(partition.trees(island));
            let slot = &mut slots.slots[slot];
            slot.work.state.clock.run_as(clock);
            lists.list(partition, island, island.lanes, slot);
        }
        let (all, local) = (T::Mask::splat(true), &lists.local[..]);
        (job.threads).for_each(&mut slots.slots, |slot| {
            if slot.in_use {
                job.solve(partition, local, all, slot, AllLanes);
            }
        });
        slots.restart();
        for island in partition.islands() {
            let slot = slots.take_own(partition.trees(island));
            let slot = &mut slots.slots[slot];
            clock.absorb(&mut slot.work.state.clock);
            results.add(job.problem, slot, all, partition.acting(), AllLanes);
        }
    }

    /// Solves the islands one after the other, each in parallel over the lanes that have it.
    fn solve_in_turn(&mut self, job: &Job<T>, clock: &mut SolveClock, results: &mut Results<T>) {
        let (partition, lists) = (&self.partition, &mut self.lists);
        for island in partition.islands() {
            let dofs = lists.count_dofs(partition.trees(island));
            if worth_lanes::<T>(island.lanes.count(), dofs) {
                let slot = self.slots.take(partition.trees(island));
                let slot = &mut self.slots.slots[slot];
                slot.work.state.clock.run_as(clock);
                lists.list(partition, island, island.lanes, slot);
                job.solve(partition, &lists.local, island.lanes, slot, AllLanes);
                clock.absorb(&mut slot.work.state.clock);
                let acting = partition.acting();
                results.add(job.problem, slot, island.lanes, acting, AllLanes);
                continue;
            }
            for k in (0..T::LANES).filter(|&k| island.lanes.lane(k)) {
                let (mut lane, slot) = (T::Mask::splat(false), &mut self.scalar);
                lane.set_lane(k, true);
                slot.work.state.clock.run_as(clock);
                lists.list(partition, island, lane, slot);
                job.solve(partition, &lists.local, lane, slot, OneLane(k));
                clock.absorb(&mut slot.work.state.clock);
                results.add(job.problem, slot, lane, partition.acting(), OneLane(k));
            }
        }
    }
}

impl<T: Real> Job<'_, T> {
    /// Solves an island, whose dofs and blocks are listed in the slot, for some of the lanes that have it.
    fn solve<F: Real>(
        &self,
        partition: &Partition<T>,
        local: &[u32],
        lanes: T::Mask,
        slot: &mut Slot<F>,
        transfer: impl Transfer<T, F>,
    ) {
        let part = Part {
            dofs: &slot.dofs,
            local,
            blocks: &slot.blocks,
            acting: partition.acting(),
            lanes,
        };
        slot.problem.gather(self.problem, &part, transfer);
        let warmstart = self.warmstart.map(|warm| {
            slot.warmstart.clear();
            let dofs = slot.dofs.iter().map(|&dof| dof as usize);
            (slot.warmstart).extend(dofs.map(|dof| transfer.convert(warm[dof])));
            &slot.warmstart[..]
        });
        slot.work.state.threads.clone_from(self.threads);
        slot.work.run(&slot.problem, self.settings, warmstart);
    }
}

impl TreeLists {
    /// Lists the dofs of each tree, ascending.
    fn list_dofs(&mut self, tree: &Tree) {
        self.local.resize(tree.nv(), 0);
        self.dofs.clear(tree.ntree());
        for dof in (0..tree.nv()).rev() {
            self.dofs.push_front(tree.tree_of(dof) as u32, dof as u32);
        }
    }

    /// Lists the blocks of each tree, ascending.
    fn list_blocks<T: Real>(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        self.blocks.clear(tree.ntree());
        for (k, b) in problem.jacobian.blocks.iter().enumerate().rev() {
            if let Some(&dof) = problem.jacobian.dofs(b).first() {
                (self.blocks).push_front(tree.tree_of(dof as usize) as u32, k as u32);
            }
        }
    }

    /// Lists in a slot the dofs of an island and the blocks that act on it in `lanes`.
    fn list<T: Real, F: Real>(
        &mut self,
        partition: &Partition<T>,
        island: &Island<T>,
        lanes: T::Mask,
        slot: &mut Slot<F>,
    ) {
        let acting = partition.acting();
        slot.dofs.clear();
        slot.blocks.clear();
        for &tree in partition.trees(island) {
            slot.dofs.extend(self.dofs.iter(tree));
            let blocks = self.blocks.iter(tree);
            (slot.blocks).extend(blocks.filter(|&k| (acting[k as usize] & lanes).any()));
        }
        slot.blocks.sort_unstable();
        if partition.is_ascending(island) {
            // The dofs of two trees may alternate.
            slot.dofs.sort_unstable();
        }
        for (local, &dof) in slot.dofs.iter().enumerate() {
            self.local[dof as usize] = local as u32;
        }
    }

    fn count_dofs(&self, trees: &[u32]) -> usize {
        trees.iter().map(|&t| self.dofs.iter(t).count()).sum()
    }
}

impl<T: Real> Slots<T> {
    /// Releases all slots for a new solve. Returns true if it is the first one over this forest.
    fn start(&mut self, tree: &Arc<Tree>) -> bool {
        let is_same_forest = self
            .tree
            .as_ref()
            .is_some_and(|stored| Arc::ptr_eq(stored, tree) || stored.parents() == tree.parents());
        if !is_same_forest {
            self.same_shape = tree.first_of_same_shape();
            self.single.clear();
            self.single.resize(tree.ntree(), None);
            self.tree = Some(tree.clone());
        }
        self.slots.iter_mut().for_each(|slot| slot.in_use = false);
        self.restart();
        !is_same_forest
    }

    /// Restarts the assignment for the same islands.
    fn restart(&mut self) {
        self.several_in_use = 0;
    }

    /// Returns the slot for the next island, once the previous one is done.
    fn take(&mut self, trees: &[u32]) -> usize {
        match *trees {
            [tree] => self.take_single(self.same_shape[tree as usize]),
            _ => self.take_several(),
        }
    }

    /// Returns a slot for the next island that no other island uses until all are solved.
    fn take_own(&mut self, trees: &[u32]) -> usize {
        let slot = match *trees {
            [tree] => self.take_single(tree),
            _ => self.take_several(),
        };
        self.slots[slot].in_use = true;
        slot
    }

    fn take_single(&mut self, tree: u32) -> usize {
        let new = self.slots.len() as u32;
        let slot = *self.single[tree as usize].get_or_insert(new);
        self.ensure(slot)
    }

    fn take_several(&mut self) -> usize {
        let new = self.slots.len() as u32;
        self.several_in_use += 1;
        if self.several.len() < self.several_in_use {
            self.several.push(new);
        }
        self.ensure(self.several[self.several_in_use - 1])
    }

    /// Returns the index of a slot, creating it if it is new.
    fn ensure(&mut self, slot: u32) -> usize {
        if slot as usize == self.slots.len() {
            self.slots.push(Slot::default());
        }
        slot as usize
    }
}
