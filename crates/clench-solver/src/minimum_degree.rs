//! The elimination order of coupled trees in a Hessian.
//!
//! Eliminating a tree couples all its neighbours. In a heap of many bodies this dominates the cost of a factorization,
//! so the tree with the fewest neighbours is eliminated next (minimum degree: Tinney & Walker 1967; George & Liu 1989).
//! Ties go to the lower number, so the order depends only on the couplings.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A graph of trees, and its elimination order.
#[derive(Clone, Debug, Default)]
pub(crate) struct MinimumDegree {
    /// The neighbours of each tree, ascending. The list of an eliminated tree does not change any more.
    neighbors: Vec<Vec<u32>>,
    /// Degrees and numbers of trees, the lowest first. A tree whose degree changes is pushed again; entries with an
    /// outdated degree are skipped.
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    /// The index of each tree in the order.
    rank: Vec<u32>,
    merged: Vec<u32>,
}

/// The rank of a tree that is not eliminated yet.
const NOT_ELIMINATED: u32 = u32::MAX;

impl MinimumDegree {
    /// Resets the graph to `count` uncoupled trees.
    pub(crate) fn clear(&mut self, count: usize) {
        self.neighbors.truncate(count);
        self.neighbors.iter_mut().for_each(Vec::clear);
        self.neighbors.resize_with(count, Vec::new);
    }

    /// Couples two trees.
    pub(crate) fn couple(&mut self, a: usize, b: usize) {
        for (one, other) in [(a, b as u32), (b, a as u32)] {
            if let (true, Err(index)) = (a != b, self.neighbors[one].binary_search(&other)) {
                self.neighbors[one].insert(index, other);
            }
        }
    }

    /// Computes the rank of each tree; the first to be eliminated has rank 0.
    pub(crate) fn ranks(&mut self) -> &[u32] {
        let count = self.neighbors.len();
        self.rank.clear();
        self.rank.resize(count, NOT_ELIMINATED);
        self.queue.clear();
        let degrees = self.neighbors.iter().map(|n| n.len() as u32).zip(0..);
        self.queue.extend(degrees.map(Reverse));
        let mut next = 0;
        while let Some(Reverse((degree, tree))) = self.queue.pop() {
            let tree = tree as usize;
            if self.rank[tree] == NOT_ELIMINATED && self.neighbors[tree].len() == degree as usize {
                self.rank[tree] = next;
                next += 1;
                self.eliminate(tree);
            }
        }
        &self.rank
    }

    /// Couples all neighbours of a tree, and removes it from their lists.
    fn eliminate(&mut self, tree: usize) {
        let clique = std::mem::take(&mut self.neighbors[tree]);
        for &one in &clique {
            let own = &mut self.neighbors[one as usize];
            merge(own, &clique, &mut self.merged);
            self.merged
                .retain(|&other| other != one && other as usize != tree);
            // Copied, not swapped: each list keeps its own memory, so the same graph needs no allocation the next time.
            own.clone_from(&self.merged);
            self.queue.push(Reverse((own.len() as u32, one)));
        }
        self.neighbors[tree] = clique;
    }
}

/// Writes the union of two ascending lists, ascending.
pub(crate) fn merge(a: &[u32], b: &[u32], out: &mut Vec<u32>) {
    out.clear();
    let (mut a, mut b) = (a, b);
    while let (Some((&x, rest_a)), Some((&y, rest_b))) = (a.split_first(), b.split_first()) {
        out.push(x.min(y));
        if x <= y {
            a = rest_a;
        }
        if y <= x {
            b = rest_b;
        }
    }
    out.extend_from_slice(a);
    out.extend_from_slice(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_is_eliminated_from_its_ends() {
        let mut star = MinimumDegree::default();
        star.clear(5);
        for end in [0, 1, 3, 4] {
            star.couple(2, end);
            star.couple(end, 2);
        }
        assert_eq!(star.ranks(), [0, 1, 3, 2, 4]);
    }

    #[test]
    fn a_path_stays_a_path_and_parts_do_not_matter_to_each_other() {
        let mut graph = MinimumDegree::default();
        for _ in 0..2 {
            graph.clear(7);
            for (a, b) in [(0, 2), (2, 4), (4, 6), (1, 3)] {
                graph.couple(a, b);
            }
            assert_eq!(graph.ranks(), [1, 2, 4, 3, 5, 0, 6]);
        }
    }

    #[test]
    fn what_a_tree_couples_counts_from_then_on() {
        // A square with a tail: eliminating a corner couples its neighbours.
        let mut graph = MinimumDegree::default();
        graph.clear(5);
        for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0), (3, 4)] {
            graph.couple(a, b);
        }
        assert_eq!(graph.ranks(), [1, 2, 3, 4, 0]);
    }
}
