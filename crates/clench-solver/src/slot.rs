//! The memory for solving one island.

use crate::problem::Problem;
use crate::tree::Tree;
use crate::workspace::Workspace;
use clench_math::Real;
use std::sync::Arc;

/// Memory for one island.
#[derive(Clone, Debug)]
pub(crate) struct Slot<F: Real> {
    /// True if an island of the current solve uses it.
    pub in_use: bool,
    /// The island's dofs, as numbered in the whole problem and in local order; its blocks, ascending.
    pub dofs: Vec<u32>,
    pub blocks: Vec<u32>,
    pub problem: Problem<F>,
    pub warmstart: Vec<F>,
    pub work: Workspace<F>,
}

impl<F: Real> Default for Slot<F> {
    fn default() -> Self {
        Slot {
            in_use: false,
            dofs: Vec::new(),
            blocks: Vec::new(),
            problem: Problem::new(Arc::new(Tree::dense(0))),
            warmstart: Vec::new(),
            work: Workspace::default(),
        }
    }
}
