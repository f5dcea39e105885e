//! The partition of the trees into islands, in each lane.
//!
//! A block couples the trees of its dofs in the lanes in which it acts. Trees coupled directly or through others form
//! an island. It is stored as a list of trees: ascending, or, with many trees, in an order that fills little of the
//! Hessian. The list depends only on the lane, so lanes with the same list can share a problem.
//!
//! Sleeping also uses the partition: bodies sleep by island.

use crate::minimum_degree::MinimumDegree;
use crate::problem::Problem;
use clench_math::{Mask, Real, kernel};
use std::cmp::Reverse;
use std::ops::Range;

/// An island, and the lanes that have it.
#[derive(Clone, Debug)]
pub struct Island<T: Real> {
    /// The lanes that have it.
    pub lanes: T::Mask,
    /// The lowest tree.
    first: u32,
    /// The range of its trees in the list of all.
    trees: Range<usize>,
}

/// The islands of all lanes.
#[derive(Clone, Debug)]
pub struct Partition<T: Real> {
    /// The lanes in which each block acts.
    acting: Vec<T::Mask>,
    /// The lanes in which some block acts on each tree.
    constrained: Vec<T::Mask>,
    couplings: Vec<Coupling<T>>,
    /// The distinct islands, ordered by their lowest tree, and the trees of all of them.
    islands: Vec<Island<T>>,
    trees: Vec<u32>,
    /// The islands of each lowest tree.
    by_first: Lists,
    /// Union-find over the trees of a lane, with the lowest as leader; the trees of each leader.
    leader: Vec<u32>,
    by_leader: Lists,
    elimination: MinimumDegree,
    /// The elimination order of each lane.
    orders: Vec<Order>,
    /// The trees of a block, then those of an island.
    members: Vec<u32>,
}

/// Two trees that a block couples.
#[derive(Clone, Copy, Debug)]
struct Coupling<T: Real> {
    trees: [u32; 2],
    lanes: T::Mask,
}

/// An elimination order, reused while the couplings of its lane do not change: those of a heap at rest seldom do.
#[derive(Clone, Debug, Default)]
struct Order {
    trees: usize,
    couplings: Vec<[u32; 2]>,
    /// The rank of each tree.
    ranks: Vec<u32>,
}

/// Islands with more trees are ordered to reduce fill; smaller ones would gain little.
const MAX_ASCENDING: usize = 8;

impl<T: Real> Default for Partition<T> {
    fn default() -> Self {
        Partition {
            acting: Vec::new(),
            constrained: Vec::new(),
            couplings: Vec::new(),
            islands: Vec::new(),
            trees: Vec::new(),
            by_first: Lists::default(),
            leader: Vec::new(),
            by_leader: Lists::default(),
            elimination: MinimumDegree::default(),
            orders: Vec::new(),
            members: Vec::new(),
        }
    }
}

impl<T: Real> Partition<T> {
    /// Computes the islands of `problem`.
    pub fn find(&mut self, problem: &Problem<T>) {
        self.survey(problem);
        self.islands.clear();
        self.trees.clear();
        self.by_first.clear(problem.tree().ntree());
        for lane in 0..T::LANES {
            self.find_in_lane(lane);
        }
        self.islands.sort_unstable_by_key(|island| island.first);
    }

    /// Returns the distinct islands, ordered by their lowest tree. The islands of one lane have the same order as if it
    /// were solved alone.
    pub fn islands(&self) -> &[Island<T>] {
        &self.islands
    }

    /// Returns the trees of an island, in their order in its problem.
    pub fn trees(&self, island: &Island<T>) -> &[u32] {
        &self.trees[island.trees.clone()]
    }

    /// Returns the lanes in which some block acts on a tree.
    pub fn constrained(&self, tree: usize) -> T::Mask {
        self.constrained[tree]
    }

    /// Returns true if the trees of an island are in ascending order.
    pub(crate) fn is_ascending(&self, island: &Island<T>) -> bool {
        island.trees.len() <= MAX_ASCENDING
    }

    /// Returns the lanes in which each block acts.
    pub(crate) fn acting(&self) -> &[T::Mask] {
        &self.acting
    }

    /// Returns true if the problem is a single small island, in all lanes and with all its blocks, so that it need not
    /// be copied.
    pub(crate) fn is_whole(&self) -> bool {
        let [island] = &self.islands[..] else {
            return false;
        };
        island.trees.len() == self.constrained.len()
            && self.is_ascending(island)
            && island.lanes.all()
            && self.acting.iter().all(|lanes| lanes.all())
    }

    /// Records the lanes in which blocks act and the trees that they couple.
    #[kernel]
    fn survey(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        let nowhere = T::Mask::splat(false);
        self.acting.clear();
        self.couplings.clear();
        self.constrained.clear();
        self.constrained.resize(tree.ntree(), nowhere);
        for b in &problem.jacobian.blocks {
            let d = &problem.d[b.rows()];
            let lanes = d.iter().fold(nowhere, |lanes, d| lanes | d.gt(T::ZERO));
            self.acting.push(lanes);
            if !lanes.any() {
                continue;
            }
            self.members.clear();
            for &dof in problem.jacobian.dofs(b) {
                let one = tree.tree_of(dof as usize) as u32;
                // Most dofs are in the tree of the dof before.
                if self.members.last() == Some(&one) || self.members.contains(&one) {
                    continue;
                }
                self.constrained[one as usize] |= lanes;
                for &other in &self.members {
                    couple(&mut self.couplings, [other, one], lanes);
                }
                self.members.push(one);
            }
        }
    }

    /// Adds the islands of a lane.
    fn find_in_lane(&mut self, lane: usize) {
        let count = self.constrained.len();
        self.leader.clear();
        self.leader.extend(0..count as u32);
        for k in 0..self.couplings.len() {
            if self.couplings[k].lanes.lane(lane) {
                let [a, b] = self.couplings[k].trees.map(|tree| self.find_leader(tree));
                self.leader[a.max(b) as usize] = a.min(b);
            }
        }
        self.by_leader.clear(count);
        for tree in (0..count as u32).rev() {
            if self.constrained[tree as usize].lane(lane) {
                let leader = self.find_leader(tree);
                self.by_leader.push_front(leader, tree);
            }
        }
        let mut ordered = false;
        for first in 0..count as u32 {
            self.members.clear();
            self.members.extend(self.by_leader.iter(first));
            if self.members.is_empty() {
                continue;
            }
            if self.members.len() > MAX_ASCENDING {
                if !ordered {
                    self.order(lane);
                    ordered = true;
                }
                // The tree that is eliminated first comes last.
                let ranks = &self.orders[lane].ranks;
                (self.members).sort_unstable_by_key(|&tree| Reverse(ranks[tree as usize]));
            }
            self.add(first, lane);
        }
    }

    fn find_leader(&mut self, tree: u32) -> u32 {
        let mut t = tree as usize;
        while self.leader[t] as usize != t {
            self.leader[t] = self.leader[self.leader[t] as usize];
            t = self.leader[t] as usize;
        }
        t as u32
    }

    /// Computes the elimination order of the trees of a lane.
    fn order(&mut self, lane: usize) {
        let trees = self.constrained.len();
        self.orders.resize_with(T::LANES, Order::default);
        let order = &mut self.orders[lane];
        let acting = self.couplings.iter().filter(|c| c.lanes.lane(lane));
        let couplings = acting.map(|coupling| coupling.trees);
        if order.trees == trees && couplings.clone().eq(order.couplings.iter().copied()) {
            return;
        }
        order.trees = trees;
        order.couplings.clear();
        order.couplings.extend(couplings);
        self.elimination.clear(trees);
        for &[a, b] in &order.couplings {
            self.elimination.couple(a as usize, b as usize);
        }
        order.ranks.clear();
        order.ranks.extend_from_slice(self.elimination.ranks());
    }

    /// Adds `members`, an island of a lane whose lowest tree is `first`.
    fn add(&mut self, first: u32, lane: usize) {
        let found = (self.by_first.iter(first)).find(|&k| {
            let trees = self.islands[k as usize].trees.clone();
            self.trees[trees] == self.members[..]
        });
        if let Some(k) = found {
            self.islands[k as usize].lanes.set_lane(lane, true);
            return;
        }
        let start = self.trees.len();
        self.trees.extend_from_slice(&self.members);
        let mut lanes = T::Mask::splat(false);
        lanes.set_lane(lane, true);
        self.by_first.push_front(first, self.islands.len() as u32);
        self.islands.push(Island {
            lanes,
            first,
            trees: start..self.trees.len(),
        });
    }
}

/// Records that a block couples two trees. Contacts of the same bodies are consecutive.
#[inline(always)]
fn couple<T: Real>(couplings: &mut Vec<Coupling<T>>, trees: [u32; 2], lanes: T::Mask) {
    match couplings.last_mut() {
        Some(last) if last.trees == trees => last.lanes |= lanes,
        _ => couplings.push(Coupling { trees, lanes }),
    }
}

/// A list of numbers for each key.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    head: Vec<u32>,
    next: Vec<u32>,
}

/// The end of a list.
const END: u32 = u32::MAX;

impl Lists {
    /// Resets to an empty list for each of `keys` keys.
    pub(crate) fn clear(&mut self, keys: usize) {
        self.head.clear();
        self.head.resize(keys, END);
    }

    /// Prepends `item`, which is in no list yet, to the list of `key`.
    pub(crate) fn push_front(&mut self, key: u32, item: u32) {
        if self.next.len() <= item as usize {
            self.next.resize(item as usize + 1, END);
        }
        self.next[item as usize] = self.head[key as usize];
        self.head[key as usize] = item;
    }

    /// Returns the list of `key`.
    pub(crate) fn iter(&self, key: u32) -> impl Iterator<Item = u32> {
        let some = |item: u32| (item != END).then_some(item);
        std::iter::successors(some(self.head[key as usize]), move |&item| {
            some(self.next[item as usize])
        })
    }
}
