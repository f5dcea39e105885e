//! The memory in which one island is solved.

use crate::Tree;
use crate::problem::Problem;
use crate::workspace::Workspace;
use clench_math::Real;
use std::sync::Arc;

/// Memory for an island.
#[derive(Clone, Debug)]
pub(crate) struct Slot<F: Real> {
    /// Whether an island of the present solve has it.
    pub taken: bool,
    /// Its dofs in the whole problem, in the order that they have here; its blocks, ascending.
    pub dofs: Vec<u32>,
    pub blocks: Vec<u32>,
    pub problem: Problem<F>,
    pub warmstart: Vec<F>,
    pub work: Workspace<F>,
}

impl<F: Real> Default for Slot<F> {
    fn default() -> Self {
        Slot {
            taken: false,
            dofs: Vec::new(),
            blocks: Vec::new(),
            problem: Problem::new(Arc::new(Tree::dense(0))),
            warmstart: Vec::new(),
            work: Workspace::default(),
        }
    }
}
