//! A bounding-volume tree over static shapes.
//!
//! Each node holds the bounding box of its shapes. The shapes are divided into two halves at the median of their
//! centres along the longest side; each half belongs to one child. A query that finds few shapes visits a few nodes per
//! level.

use super::aabb::Aabb;

/// The maximum number of shapes in a leaf.
const LEAF: usize = 4;
/// The maximum depth: 2³² shapes divided by halves need less. A search holds one open node per level.
const MAX_DEPTH: usize = 40;

/// The tree. Its memory grows to the largest number of shapes seen.
#[derive(Clone, Debug, Default)]
pub(super) struct StaticTree {
    /// The nodes in depth-first order, first children first.
    nodes: Vec<Node>,
    /// The shapes with their boxes, leaf by leaf.
    leaves: Vec<(u32, Aabb)>,
    /// The shapes without bounds, such as planes.
    unbounded: Vec<u32>,
    /// The pending ranges to divide: parent node, begin and end of the shapes.
    open: Vec<(usize, usize, usize)>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    kind: NodeKind,
}

#[derive(Clone, Copy, Debug)]
enum NodeKind {
    /// A range of shapes.
    Leaf { begin: u32, end: u32 },
    /// An inner node: the first child is the next node, the second this one.
    Inner { second: u32 },
}

impl StaticTree {
    /// Rebuilds the tree over the given shapes.
    pub(super) fn build(&mut self, shapes: impl Iterator<Item = (u32, Aabb)>) {
        self.nodes.clear();
        self.leaves.clear();
        self.unbounded.clear();
        for (shape, bounds) in shapes {
            match bounds.is_finite() {
                true => self.leaves.push((shape, bounds)),
                false => self.unbounded.push(shape),
            }
        }
        if self.leaves.is_empty() {
            return;
        }
        self.open.push((usize::MAX, 0, self.leaves.len()));
        while let Some((parent, begin, end)) = self.open.pop() {
            let index = self.nodes.len();
            if let Some(parent) = self.nodes.get_mut(parent) {
                parent.kind = NodeKind::Inner {
                    second: index as u32,
                };
            }
            self.divide(index, begin, end);
        }
    }

    /// Adds a node and all first children below it; second children stay pending.
    fn divide(&mut self, mut index: usize, begin: usize, mut end: usize) {
        loop {
            let shapes = &mut self.leaves[begin..end];
            let bounds = (shapes.iter()).fold(Aabb::EMPTY, |all, (_, one)| all.union(one));
            let kind = NodeKind::Leaf {
                begin: begin as u32,
                end: end as u32,
            };
            self.nodes.push(Node { bounds, kind });
            if shapes.len() <= LEAF {
                return;
            }
            let side = |axis: usize| bounds.high[axis] - bounds.low[axis];
            let axis = (0..3).fold(0, |largest, axis| {
                if side(axis) > side(largest) {
                    axis
                } else {
                    largest
                }
            });
            let center = |(_, one): &(u32, Aabb)| one.low[axis] + one.high[axis];
            let middle = shapes.len() / 2;
            shapes.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
            self.open.push((index, begin + middle, end));
            (index, end) = (index + 1, begin + middle);
        }
    }

    /// Calls `found` for every shape whose box overlaps `bounds`.
    pub(super) fn overlapping(&self, bounds: &Aabb, mut found: impl FnMut(u32)) {
        self.unbounded.iter().for_each(|&shape| found(shape));
        if self.nodes.is_empty() {
            return;
        }
        let mut open = [0_u32; MAX_DEPTH];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = open[count] as usize;
            let node = &self.nodes[index];
            if !node.bounds.overlaps(bounds) {
                continue;
            }
            match node.kind {
                NodeKind::Leaf { begin, end } => {
                    let leaves = &self.leaves[begin as usize..end as usize];
                    let met = leaves.iter().filter(|(_, one)| one.overlaps(bounds));
                    met.for_each(|&(shape, _)| found(shape));
                }
                NodeKind::Inner { second } => {
                    open[count] = second;
                    open[count + 1] = index as u32 + 1;
                    count += 2;
                }
            }
        }
    }
}
