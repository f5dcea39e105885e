//! A bounding-volume tree over shapes that do not move.
//!
//! Each node holds the box about its shapes; half of them, on either side of the median of their centres along the longest side, are its
//! first child's, the rest its second's. Asking which shapes a box meets takes some steps a level where it meets few.

use super::aabb::Aabb;

/// A node of so few shapes is not divided.
const LEAF: usize = 4;
/// A tree over 2³² shapes, divided by halves, is not deeper; a search holds one open node a level.
const MAX_DEPTH: usize = 40;

/// The tree. Its memory grows to the largest number of shapes seen.
#[derive(Clone, Debug, Default)]
pub(super) struct StaticTree {
    /// A node before its first child, all of the first child's before the second.
    nodes: Vec<Node>,
    /// Shapes with their boxes, leaf after leaf.
    leaves: Vec<(u32, Aabb)>,
    /// Shapes without bounds, as planes.
    unbounded: Vec<u32>,
    /// What is still to be divided: node, begin and end of its shapes.
    open: Vec<(usize, usize, usize)>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    kind: NodeKind,
}

#[derive(Clone, Copy, Debug)]
enum NodeKind {
    /// The shapes of a range.
    Leaf { begin: u32, end: u32 },
    /// The first child is the next node, the second this one.
    Inner { second: u32 },
}

impl StaticTree {
    /// Builds the tree anew over these shapes.
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

    /// Adds a node of these shapes, and all first children below it; their second children stay open.
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
            let axis = (0..3).fold(
                0,
                |most, axis| if side(axis) > side(most) { axis } else { most },
            );
            let center = |(_, one): &(u32, Aabb)| one.low[axis] + one.high[axis];
            let middle = shapes.len() / 2;
            shapes.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
            self.open.push((index, begin + middle, end));
            (index, end) = (index + 1, begin + middle);
        }
    }

    /// Hands every shape to `found` whose box meets this one.
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
