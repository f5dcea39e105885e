//! The work that a step skips for sleeping trees.
//!
//! Nothing of a tree is computed again while it sleeps at the positions of the last pass, in which it also slept. If no
//! lane has an awake tree, and nothing can wake one, a step only advances time. The workspace then holds the results of
//! the last pass; they are exact if all trees slept in it at their present positions. Otherwise the step is done in
//! full once, unless the workspace is not read.

use super::wake::wake_coupled;
use super::{Sleep, all_blank, all_same, mocap_pose, wake_touched};
use crate::fixed::FixedPoses;
use crate::model::Model;
use crate::part::Part;
use crate::state::State;
use crate::state::bounds::are_occasional;
use crate::workspace::Workspace;
use clench_math::{Clock, Mask, Real, kernel};
use clench_solver::Tree;
use std::ops::Range;

/// Returns true if everything sleeps as the last pass left it, so that a step only advances time. Models with elements
/// that act on sleeping trees other than by forces, or that are written in every step, are left to [`is_idle`].
#[kernel]
pub fn sleeps_unchanged<T: Real>(model: &Model, state: &State<T>, ws: &Workspace<T>) -> bool {
    let sleep = &ws.sleep;
    let bare = model.actuators.is_empty()
        && model.equalities.is_empty()
        && model.nhistory == 0
        && state.plastic.is_empty();
    bare && !ws.collision.contacts_provided
        && sleep.stays_at_rest(model, state)
        && all_same(&state.tree_asleep, &sleep.counters)
        && all_same(&state.pose_asleep, &sleep.pose)
        && all_blank(&state.qvel)
        && all_blank(&state.qacc_warmstart)
        && all_blank(&state.qfrc_applied)
        && are_occasional(state, all_blank)
        && (0..T::LANES).all(|lane| state.time.lane(lane).is_finite())
}

/// Returns true if a step only advances time: nothing is awake, nothing wakes, and the model has no actuators and no
/// past values. Mocap bodies must not have moved.
#[kernel]
pub(crate) fn is_idle<T: Real>(model: &Model, state: &State<T>, ws: &mut Workspace<T>) -> bool {
    if !model.actuators.is_empty() || model.nhistory > 0 || ws.collision.contacts_provided {
        return false;
    }
    wake_touched(model, state, ws);
    if !ws.sleep.all_asleep().all() {
        return false;
    }
    if wake_coupled(model, state, ws) {
        // A pass first detects wakes by touch, and only among trees that are not yet awake.
        ws.sleep.begin(model, state);
        return false;
    }
    ws.sleep.stays_at_rest(model, state) || (model.nmocap == 0 && !ws.read)
}

impl<T: Real> Sleep<T> {
    /// Invalidates all poses, so that the next pass computes them.
    pub fn invalidate(&mut self) {
        (self.has_results, self.at_rest) = (false, false);
        self.parts.select_all();
    }

    /// Records a pass over a state.
    pub fn record_pass(&mut self, model: &Model, state: &State<T>) {
        let (qpos, mocap) = self.pose.split_at_mut(model.nq);
        qpos.copy_from_slice(&state.qpos);
        for (m, pose) in mocap.chunks_exact_mut(7).enumerate() {
            pose.copy_from_slice(&mocap_pose(state, m));
        }
        self.parts.end_pass();
        self.has_results = true;
        self.at_rest = self.all_asleep().all();
    }

    /// Returns the parts whose poses the position stage computes: [`computed`](Self::computed), but never bodies on the
    /// world whose fixed poses are valid.
    pub fn parts<'a>(&'a self, fixed: &'a FixedPoses) -> &'a [Part] {
        match self.enabled {
            true => self.computed(),
            false => fixed.parts(),
        }
    }

    /// Returns the parts that the stages of the pass compute: all but trees that sleep as in the last pass, and, if any
    /// tree can sleep, bodies on the world whose fixed poses are valid.
    pub fn computed(&self) -> &[Part] {
        self.parts.get()
    }

    /// Returns the sparsity of the mass matrix, limited to the rows of these parts.
    pub(crate) fn rows<'a>(&'a self, model: &'a Model) -> &'a Tree {
        self.parts.rows(model)
    }

    /// Adds the trees that woke during the pass, if any, to the parts that its other stages compute. They overwrite
    /// the results of the last pass.
    pub(crate) fn add_woken(
        &mut self,
        model: &Model,
        state: &State<T>,
        fixed: &FixedPoses,
        woke: bool,
    ) {
        if woke && self.has_results {
            self.find_parts(model, state, fixed);
        }
        (self.has_results, self.at_rest) = (false, false);
    }

    /// Finds the parts that a pass over a state computes.
    #[inline(never)]
    pub(crate) fn find_parts(&mut self, model: &Model, state: &State<T>, fixed: &FixedPoses) {
        if !self.has_results {
            self.parts.select_all();
            return;
        }
        for (t, tree) in model.trees.iter().enumerate() {
            let same = self.lies_as_before(tree.qpos.clone(), state);
            self.parts.set_same(t, same);
        }
        self.parts.select(model, fixed);
    }

    /// Returns true if positions are those of the last pass.
    fn lies_as_before(&self, qpos: Range<usize>, state: &State<T>) -> bool {
        all_same(&self.pose[qpos.clone()], &state.qpos[qpos])
    }

    /// Returns true if all trees slept in the last pass at their present positions, and no mocap body has moved.
    fn stays_at_rest(&self, model: &Model, state: &State<T>) -> bool {
        let mut mocap = self.pose[model.nq..].chunks_exact(7).enumerate();
        self.at_rest
            && self.lies_as_before(0..model.nq, state)
            && mocap.all(|(m, pose)| {
                (pose.iter().zip(&mocap_pose(state, m))).all(|(one, other)| one.eq(*other).all())
            })
    }
}
