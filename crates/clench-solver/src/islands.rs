//! Islands: trees that no constraint couples are separate problems.
//!
//! Each island is copied into a compact problem of its own and solved as if nothing else existed: fewer iterations where
//! another island is hard, smaller factors, and a stop rule in its own scale. Trees on which no constraint acts are not
//! touched at all. Slots are kept by island number, so that a scene that stays as it is reuses its patterns.
//!
//! The trees of a large island are numbered anew, so that eliminating them fills little of its Hessian.

use crate::elimination::Elimination;
use crate::problem::Problem;
use crate::workspace::Workspace;
use crate::{Settings, SolveClock, SolveStats, Tree};
use clench_math::{Mask, Real};
use std::cmp::Reverse;
use std::sync::Arc;

/// The partition, and a compact problem for each part.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands<T: Real> {
    /// Union-find over trees.
    leader: Vec<u32>,
    /// The island of each tree, or `FREE`.
    island_of: Vec<u32>,
    /// The island-local index of each dof.
    local: Vec<u32>,
    /// How many trees each island has.
    sizes: Vec<usize>,
    elimination: Elimination,
    /// The trees of a block.
    coupled: Vec<usize>,
    /// A slot for each island, and perhaps more from earlier.
    slots: Vec<Island<T>>,
}

/// One part.
#[derive(Clone, Debug)]
pub(crate) struct Island<T: Real> {
    /// Its dofs in the whole problem, in the order that they have here; its blocks, ascending.
    pub dofs: Vec<u32>,
    pub blocks: Vec<u32>,
    pub problem: Problem<T>,
    warmstart: Vec<T>,
    pub work: Workspace<T>,
}

/// Marks a tree without constraints.
const FREE: u32 = u32::MAX;

/// Islands of more trees are numbered anew; smaller ones have little to gain.
const MOST_IN_PLACE: usize = 8;

impl<T: Real> Islands<T> {
    /// Finds the islands of `problem`; true if they are worth solving by parts: not if a single small one covers everything.
    pub fn find(&mut self, problem: &Problem<T>) -> bool {
        let tree = problem.tree();
        self.leader.clear();
        self.leader.extend(0..tree.ntree() as u32);
        self.island_of.clear();
        self.island_of.resize(tree.ntree(), FREE);
        for block in problem.blocks().filter(|b| acts(b.d)) {
            let Some((&first, rest)) = block.dofs.split_first() else {
                continue;
            };
            let mut leader = self.find_leader(tree.tree_of(first as usize));
            for &dof in rest {
                let other = self.find_leader(tree.tree_of(dof as usize));
                // The lower number leads, so that islands are numbered by their first tree.
                let (low, high) = (leader.min(other), leader.max(other));
                self.leader[high] = low as u32;
                leader = low;
            }
        }
        for block in problem.blocks().filter(|b| acts(b.d)) {
            if let Some(&dof) = block.dofs.first() {
                let leader = self.find_leader(tree.tree_of(dof as usize));
                self.island_of[leader] = 0;
            }
        }
        self.sizes.clear();
        for t in 0..tree.ntree() {
            let leader = self.find_leader(t);
            if leader != t {
                self.island_of[t] = self.island_of[leader];
            } else if self.island_of[t] != FREE {
                self.island_of[t] = self.sizes.len() as u32;
                self.sizes.push(0);
            }
            if self.island_of[t] != FREE {
                self.sizes[self.island_of[t] as usize] += 1;
            }
        }
        self.sizes.len() != 1 || self.has_large() || self.island_of.contains(&FREE)
    }

    fn has_large(&self) -> bool {
        self.sizes.iter().any(|&size| size > MOST_IN_PLACE)
    }

    fn find_leader(&mut self, tree: usize) -> usize {
        let mut t = tree;
        while self.leader[t] as usize != t {
            self.leader[t] = self.leader[self.leader[t] as usize];
            t = self.leader[t] as usize;
        }
        t
    }

    /// Solves each island; returns them and their statistics combined.
    pub fn solve(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        warmstart: Option<&[T]>,
        clock: &mut SolveClock,
    ) -> (&[Island<T>], SolveStats<T>) {
        self.gather(problem);
        let mut stats = SolveStats::default();
        for island in &mut self.slots[..self.sizes.len()] {
            let warmstart = warmstart.map(|warm| {
                island.warmstart.clear();
                island
                    .warmstart
                    .extend(island.dofs.iter().map(|&dof| warm[dof as usize]));
                &island.warmstart[..]
            });
            std::mem::swap(&mut island.work.course.clock, clock);
            island.work.run(&island.problem, settings, warmstart);
            std::mem::swap(&mut island.work.course.clock, clock);
            stats.combine(&island.work.course.stats);
        }
        (&self.slots[..self.sizes.len()], stats)
    }

    /// Copies the dofs and blocks of each island into its slot.
    fn gather(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        while self.slots.len() < self.sizes.len() {
            self.slots.push(Island {
                dofs: Vec::new(),
                blocks: Vec::new(),
                problem: Problem::new(Arc::new(Tree::dense(0))),
                warmstart: Vec::new(),
                work: Workspace::default(),
            });
        }
        for slot in &mut self.slots[..self.sizes.len()] {
            slot.dofs.clear();
            slot.blocks.clear();
        }
        for dof in 0..tree.nv() {
            let island = self.island_of[tree.tree_of(dof)];
            if island != FREE {
                self.slots[island as usize].dofs.push(dof as u32);
            }
        }
        if self.has_large() {
            self.reorder(problem);
        }
        self.local.clear();
        self.local.resize(tree.nv(), FREE);
        for slot in &self.slots[..self.sizes.len()] {
            for (local, &dof) in slot.dofs.iter().enumerate() {
                self.local[dof as usize] = local as u32;
            }
        }
        for (k, block) in problem.blocks().enumerate().filter(|(_, b)| acts(b.d)) {
            if let Some(&dof) = block.dofs.first() {
                let island = self.island_of[tree.tree_of(dof as usize)];
                self.slots[island as usize].blocks.push(k as u32);
            }
        }
        for slot in &mut self.slots[..self.sizes.len()] {
            slot.problem
                .gather(problem, &slot.dofs, &self.local, &slot.blocks);
        }
    }

    /// Orders the dofs of large islands so that the tree to be eliminated first comes last.
    fn reorder(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        self.elimination.clear(tree.ntree());
        for block in problem.blocks().filter(|b| acts(b.d)) {
            self.coupled.clear();
            for &dof in block.dofs {
                let one = tree.tree_of(dof as usize);
                if self.coupled.contains(&one) {
                    continue;
                }
                for &other in &self.coupled {
                    self.elimination.couple(one, other);
                }
                self.coupled.push(one);
            }
        }
        let ranks = self.elimination.ranks();
        for (slot, &size) in self.slots.iter_mut().zip(&self.sizes) {
            if size > MOST_IN_PLACE {
                let place = |dof: &u32| (Reverse(ranks[tree.tree_of(*dof as usize)]), *dof);
                slot.dofs.sort_unstable_by_key(place);
            }
        }
    }
}

/// Whether a block acts in some lane.
fn acts<T: Real>(d: &[T]) -> bool {
    d.iter().any(|d| d.gt(T::ZERO).any())
}
