//! What a step leaves out because it sleeps.
//!
//! Poses of trees that sleep, and lie where they lay when the workspace's poses were computed, need not be computed again.
//! If no lane has a tree that is awake, and nothing can wake one, a step only lets time pass. What the workspace holds then is
//! that of the last pass, if all trees slept in it where they sleep now: no number of it would come out differently. Otherwise
//! the step is done in full once, unless nobody reads the workspace.

use super::wake::wake_coupled;
use super::{Sleep, hold, mocap_pose, wake_touched};
use crate::constraint::assemble;
use crate::model::{Model, Params};
use crate::sensor;
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, kernel};
use std::ops::Range;

/// Whether a step only lets time pass. Actuators and mocap bodies act on what sleeps, or may touch it, and past values are
/// written in every step, so a model that has them is looked at in full.
#[kernel]
pub(crate) fn is_idle<T: Real>(model: &Model, state: &State<T>, ws: &mut Workspace<T>) -> bool {
    if !model.actuators.is_empty() || model.nhistory > 0 || ws.collision.given {
        return false;
    }
    wake_touched(model, state, ws);
    if !ws.sleep.all_asleep().all() {
        return false;
    }
    if wake_coupled(model, state, ws) {
        // A pass looks for what touches before, and for that among what is not yet awake.
        ws.sleep.begin(model, state);
        return false;
    }
    ws.sleep.rests_as_before(model, state) || (model.nmocap == 0 && !ws.read)
}

/// Does a step that only lets time pass.
pub(crate) fn idle<T: Real>(
    model: &Model,
    params: &Params<T>,
    settings: &StepSettings,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    if !ws.sleep.at_rest {
        clear(model, params, settings, state, ws);
    }
    sensor::evaluate(model, params, settings, state, ws);
    state.pass(params.timestep);
    hold(model, state, ws);
    state.qacc_warmstart.fill(T::ZERO);
}

/// Makes the workspace say that nothing acts and nothing went wrong. Its poses and forces are not updated.
fn clear<T: Real>(
    model: &Model,
    params: &Params<T>,
    settings: &StepSettings,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    ws.contacts.clear();
    ws.collision.excess = T::ZERO;
    ws.collision.overflow = T::Mask::splat(false);
    ws.singular = T::Mask::splat(false);
    ws.problem.qacc_smooth.fill(T::ZERO);
    assemble(model, params, settings, state, ws);
    (ws.solver.solve(&ws.problem, &settings.solver, None))
        .expect("a problem without constraints has the model's lengths");
    ws.qacc.fill(T::ZERO);
    ws.qfrc_constraint.fill(T::ZERO);
}

impl<T: Real> Sleep<T> {
    /// Has the next pass compute all poses, because what the workspace holds was computed from other numbers.
    pub(crate) fn forget(&mut self) {
        (self.placed, self.at_rest) = (false, false);
        if self.enabled {
            self.parts.clear();
            self.parts.push(0..self.bodies.len());
        }
    }

    /// Takes note of a pass over a state.
    pub(crate) fn note(&mut self, model: &Model, state: &State<T>) {
        let (qpos, mocap) = self.pose.split_at_mut(model.nq);
        qpos.copy_from_slice(&state.qpos);
        for (m, pose) in mocap.chunks_exact_mut(7).enumerate() {
            pose.copy_from_slice(&mocap_pose(state, m));
        }
        self.placed = true;
        self.at_rest = self.all_asleep().all();
    }

    /// Ranges of the bodies whose poses the position stage computes: all but those of trees on the world that sleep where they slept in
    /// the last pass.
    pub(crate) fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    /// Finds [`parts`](Self::parts) for a state.
    pub(crate) fn find_parts(&mut self, model: &Model, state: &State<T>) {
        self.parts.clear();
        let mut start = 0;
        for (tree, awake) in model.trees.iter().zip(&self.awake) {
            let apart = !awake.any() && model.bodies[tree.bodies.start].parent == 0;
            if apart && self.placed && self.lies_as_before(tree.qpos.clone(), state) {
                if start < tree.bodies.start {
                    self.parts.push(start..tree.bodies.start);
                }
                start = tree.bodies.end;
            }
        }
        self.parts.push(start..model.nbody());
    }

    /// Whether positions are those of the last pass.
    fn lies_as_before(&self, qpos: Range<usize>, state: &State<T>) -> bool {
        let pairs = self.pose[qpos.clone()].iter().zip(&state.qpos[qpos]);
        pairs.fold(true, |same, (one, other)| same && one.eq(*other).all())
    }

    /// Whether all trees slept in the last pass where they sleep now, and no mocap body has moved.
    fn rests_as_before(&self, model: &Model, state: &State<T>) -> bool {
        let mut mocap = self.pose[model.nq..].chunks_exact(7).enumerate();
        self.at_rest
            && self.lies_as_before(0..model.nq, state)
            && mocap.all(|(m, pose)| {
                (pose.iter().zip(&mocap_pose(state, m))).all(|(one, other)| one.eq(*other).all())
            })
    }
}
