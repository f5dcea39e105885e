//! Which trees form an island, in each lane.
//!
//! A block couples the trees of its dofs in the lanes in which it acts. What is coupled, directly or through others, is an
//! island. It is written as a list of trees: ascending, and in an order that fills little of the Hessian where there are
//! many. That list follows from the lane alone, so lanes with the same list can share a problem.
//!
//! Others than the solver ask for it too: what sleeps, sleeps by islands.

use crate::Problem;
use crate::minimum_degree::MinimumDegree;
use clench_math::{Mask, Real, kernel};
use std::cmp::Reverse;
use std::ops::Range;

/// An island, and the lanes that have it.
#[derive(Clone, Debug)]
pub struct Island<T: Real> {
    /// The lanes that have it.
    pub lanes: T::Mask,
    /// Its lowest tree.
    first: u32,
    /// Where its trees are listed.
    trees: Range<usize>,
}

/// The islands of all lanes.
#[derive(Clone, Debug)]
pub struct Partition<T: Real> {
    /// Lanes in which each block acts.
    acting: Vec<T::Mask>,
    /// Lanes in which some block acts on each tree.
    constrained: Vec<T::Mask>,
    couplings: Vec<Coupling<T>>,
    /// The distinct islands, by their lowest tree, and the trees of all of them.
    islands: Vec<Island<T>>,
    trees: Vec<u32>,
    /// The islands of each lowest tree.
    by_first: Lists,
    /// Union-find over the trees of a lane, the lowest leads; the trees of each leader.
    leader: Vec<u32>,
    by_leader: Lists,
    elimination: MinimumDegree,
    /// The order of elimination of each lane.
    orders: Vec<Order>,
    /// The trees of a block, those of an island.
    members: Vec<u32>,
}

/// Two trees that a block couples.
#[derive(Clone, Copy, Debug)]
struct Coupling<T: Real> {
    trees: [u32; 2],
    lanes: T::Mask,
}

/// An order of elimination, kept while the couplings of its lane stay: those of a heap at rest seldom change.
#[derive(Clone, Debug, Default)]
struct Order {
    trees: usize,
    couplings: Vec<[u32; 2]>,
    /// The rank of each tree.
    ranks: Vec<u32>,
}

/// Islands of more trees are ordered so that eliminating them fills little; smaller ones have little to gain.
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
    /// Finds the islands of `problem`.
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

    /// The distinct islands, by their lowest tree: those of a lane in the order in which it has them alone.
    pub fn islands(&self) -> &[Island<T>] {
        &self.islands
    }

    /// The trees of an island, in the order in which they stand in its problem.
    pub fn trees(&self, island: &Island<T>) -> &[u32] {
        &self.trees[island.trees.clone()]
    }

    /// The lanes in which some block acts on a tree.
    pub fn constrained(&self, tree: usize) -> T::Mask {
        self.constrained[tree]
    }

    /// Whether the trees of an island are in ascending order.
    pub(crate) fn is_ascending(&self, island: &Island<T>) -> bool {
        island.trees.len() <= MAX_ASCENDING
    }

    /// The lanes in which each block acts.
    pub(crate) fn acting(&self) -> &[T::Mask] {
        &self.acting
    }

    /// Whether the problem is a single small island, in all lanes and with all of its blocks: then it need not be copied.
    pub(crate) fn is_whole(&self) -> bool {
        let [island] = &self.islands[..] else {
            return false;
        };
        island.trees.len() == self.constrained.len()
            && self.is_ascending(island)
            && island.lanes.all()
            && self.acting.iter().all(|lanes| lanes.all())
    }

    /// Notes where blocks act and what they couple.
    #[kernel]
    fn survey(&mut self, problem: &Problem<T>) {
        let tree = problem.tree();
        let nowhere = T::Mask::splat(false);
        self.acting.clear();
        self.couplings.clear();
        self.constrained.clear();
        self.constrained.resize(tree.ntree(), nowhere);
        for block in problem.blocks() {
            let lanes = (block.d.iter()).fold(nowhere, |lanes, d| lanes | d.gt(T::ZERO));
            self.acting.push(lanes);
            if !lanes.any() {
                continue;
            }
            self.members.clear();
            for &dof in block.dofs {
                let one = tree.tree_of(dof as usize) as u32;
                if self.members.contains(&one) {
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
                // The tree to be eliminated first comes last.
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

    /// Finds the order in which to eliminate the trees of a lane.
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
        let known = (self.by_first.iter(first)).find(|&k| {
            let trees = self.islands[k as usize].trees.clone();
            self.trees[trees] == self.members[..]
        });
        if let Some(k) = known {
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

/// Notes that a block couples two trees. Contacts of the same bodies follow each other.
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
    /// An empty list for each of `keys` keys.
    pub(crate) fn clear(&mut self, keys: usize) {
        self.head.clear();
        self.head.resize(keys, END);
    }

    /// Puts `item`, which is in no list yet, before those of `key`.
    pub(crate) fn push_front(&mut self, key: u32, item: u32) {
        if self.next.len() <= item as usize {
            self.next.resize(item as usize + 1, END);
        }
        self.next[item as usize] = self.head[key as usize];
        self.head[key as usize] = item;
    }

    /// The list of `key`.
    pub(crate) fn iter(&self, key: u32) -> impl Iterator<Item = u32> {
        let some = |item: u32| (item != END).then_some(item);
        std::iter::successors(some(self.head[key as usize]), move |&item| {
            some(self.next[item as usize])
        })
    }
}
