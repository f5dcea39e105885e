//! The parts of a model that a pass computes. It omits trees whose results are still valid because they sleep.

use crate::fixed::FixedPoses;
use crate::model::{Integrator, Model, Transmission};
use crate::part::Part;
use clench_solver::Tree;
use std::slice::from_ref;

/// The parts that a pass computes.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    /// True if the pass computes the whole model.
    all: bool,
    whole: Part,
    parts: Vec<Part>,
    /// The sparsity of the mass matrix, limited to the rows of the parts.
    rows: Tree,
    trees: Vec<TreeResults>,
}

/// The validity of the results of a tree.
#[derive(Clone, Copy, Debug)]
struct TreeResults {
    /// True if a pass may omit the tree: it stands on the world, and neither tendons nor actuators act on it, so that
    /// its results depend only on its own state.
    isolated: bool,
    /// True if the tree is awake in any lane.
    awake: bool,
    /// True if it was awake in the last pass.
    was_awake: bool,
    /// True if its results are valid.
    valid: bool,
}

impl Parts {
    /// Selects the whole model. If no tree can sleep, that never changes.
    #[cold] // Compiled for size.
    pub(super) fn new(model: &Model) -> Self {
        let mut parts = Parts {
            all: true,
            whole: Part::whole(model),
            parts: Vec::new(),
            rows: Tree::default(),
            trees: Vec::new(),
        };
        if model.may_sleep() {
            parts.rows.clone_from(&model.tree);
            parts
                .trees
                .extend(model.trees.iter().map(|tree| TreeResults {
                    isolated: model.bodies[tree.bodies.start].parent == 0,
                    awake: true,
                    was_awake: true,
                    valid: false,
                }));
            parts.find_isolated(model);
        }
        parts
    }

    fn find_isolated(&mut self, model: &Model) {
        for dofs in [&model.tendon_dofs, &model.actuator_dofs] {
            for &dof in dofs.all_dofs() {
                self.trees[model.tree.tree_of(dof as usize)].isolated = false;
            }
        }
        for actuator in &model.actuators {
            if let Transmission::Body(body) = actuator.transmission
                && let Some(tree) = model.tree_of_body(body)
            {
                self.trees[tree].isolated = false;
            }
        }
        // Rest positions of springs may be written, and the metric couples trees.
        if model.nplastic > 0 || model.integrator == Integrator::Discrete {
            self.trees.iter_mut().for_each(|tree| tree.isolated = false);
        }
    }

    /// Records whether a tree is awake in any lane.
    pub(super) fn set_awake(&mut self, tree: usize, awake: bool) {
        self.trees[tree].awake = awake;
    }

    /// Returns true if a tree is awake in any lane. Trees must be able to sleep.
    pub(crate) fn is_awake(&self, tree: usize) -> bool {
        self.trees[tree].awake
    }

    /// Returns true if the pass omits a tree; false for bodies of no tree.
    pub(crate) fn omits(&self, tree: Option<usize>) -> bool {
        !self.all && tree.is_some_and(|tree| self.trees[tree].valid)
    }

    /// Records that a pass ends.
    pub(super) fn end_pass(&mut self) {
        for tree in &mut self.trees {
            tree.was_awake = tree.awake;
        }
    }

    /// Records whether the positions of a tree are those of the last pass. Its results are then valid if it sleeps, and
    /// slept in that pass, in all lanes.
    pub(super) fn set_same(&mut self, tree: usize, same: bool) {
        let tree = &mut self.trees[tree];
        tree.valid = same && tree.isolated && !tree.awake && !tree.was_awake;
    }

    /// Selects the whole model.
    pub(super) fn select_all(&mut self) {
        self.all = true;
    }

    /// Selects all but the valid trees, and bodies on the world in which nothing moves.
    pub(super) fn select(&mut self, model: &Model, fixed: &FixedPoses) {
        self.all = false;
        let (moves, trees) = (fixed.moves(), &self.trees);
        let includes = |body: usize| {
            let tree = model.tree_of_body(body);
            moves[body] && !tree.is_some_and(|tree| trees[tree].valid)
        };
        Part::list(model, &includes, &mut self.parts);
        let dofs = self.parts.iter().map(|part| part.dofs.clone());
        self.rows.limit_rows(&model.tree, dofs);
    }

    /// Returns the parts.
    pub(super) fn get(&self) -> &[Part] {
        match self.all {
            true => from_ref(&self.whole),
            false => &self.parts,
        }
    }

    /// Returns the sparsity of the mass matrix, limited to the rows of the parts.
    pub(super) fn rows<'a>(&'a self, model: &'a Model) -> &'a Tree {
        match self.all {
            true => &model.tree,
            false => &self.rows,
        }
    }
}
