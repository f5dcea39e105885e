//! The listed candidates of which a tree is awake. The others make no contact and are skipped.

use super::Candidate;
use crate::model::Model;
use crate::sleep::Parts;
use std::ops::Range;

/// Marks candidates by their trees.
#[derive(Clone, Debug, Default)]
pub(super) struct AwakePairs {
    /// The candidates of each tree.
    of_tree: Vec<Vec<u32>>,
    /// The candidates of mocap bodies, which are always awake.
    of_mocap: Vec<u32>,
    /// True for the candidates that are marked; empty in a model in which nothing sleeps.
    marked: Vec<bool>,
}

impl AwakePairs {
    /// Lists the candidates of each tree if trees can sleep.
    #[cold] // Compiled for size.
    pub(super) fn new(model: &Model, candidates: &[Candidate]) -> Self {
        if !model.may_sleep() {
            return AwakePairs::default();
        }
        let mut of_tree: Vec<Vec<u32>> = Vec::new();
        of_tree.resize_with(model.ntree(), Vec::new);
        let mut of_mocap = Vec::new();
        for (index, candidate) in candidates.iter().enumerate() {
            for geom in candidate.geoms {
                let body = model.geoms[geom as usize].body;
                let list = match model.tree_of_body(body) {
                    Some(tree) => &mut of_tree[tree],
                    None if model.is_fixed(body) => continue,
                    None => &mut of_mocap,
                };
                list.push(index as u32);
            }
        }
        AwakePairs {
            of_tree,
            of_mocap,
            marked: vec![false; candidates.len()],
        }
    }

    /// Marks the candidates of mocap bodies and of awake trees; all without `parts`.
    pub(super) fn mark(&mut self, parts: Option<&Parts>) {
        let Some(parts) = parts else {
            self.marked.fill(true);
            return;
        };
        self.marked.fill(false);
        let trees = self.of_tree.iter().enumerate();
        let awake = trees.filter_map(|(tree, list)| parts.is_awake(tree).then_some(list));
        for &index in awake.chain([&self.of_mocap]).flatten() {
            self.marked[index as usize] = true;
        }
    }

    /// Removes the first consecutive marked candidates from the start of `rest` and returns them; all of `rest` in a
    /// model in which nothing sleeps.
    pub(super) fn next(&self, rest: &mut Range<usize>) -> Option<Range<usize>> {
        let (mut start, mut end) = (rest.start, rest.end);
        if let Some(marked) = self.marked.get(rest.clone()) {
            start += marked.iter().position(|&marked| marked)?;
            let run = self.marked[start..end].iter().position(|&marked| !marked);
            end = run.map_or(end, |run| start + run);
        }
        rest.start = end;
        (start < end).then_some(start..end)
    }
}
