//! The work that a step skips for sleeping trees.
//!
//! The poses of sleeping trees are not computed again if their positions are those of the workspace's poses. If no lane
//! has an awake tree, and nothing can wake one, a step only advances time. The workspace then holds the results of the
//! last pass; they are exact if all trees slept in it at their present positions. Otherwise the step is done in full
//! once, unless the workspace is not read.

use super::wake::wake_coupled;
use super::{Sleep, is_blank, mocap_pose, wake_touched};
use crate::fixed::FixedPoses;
use crate::model::Model;
use crate::state::State;
use crate::state::bounds::are_occasional;
use crate::workspace::Workspace;
use clench_math::{Clock, Mask, Real, kernel};
use std::ops::Range;

/// Returns true if everything sleeps as the last pass left it, so that a step only advances time. Models with elements
/// that act on sleeping trees other than by forces, or that are written in every step, are left to [`is_idle`].
#[kernel]
pub fn rests<T: Real>(model: &Model, state: &State<T>, ws: &Workspace<T>) -> bool {
    let sleep = &ws.sleep;
    let bare = model.actuators.is_empty()
        && model.equalities.is_empty()
        && model.nhistory == 0
        && state.plastic.is_empty();
    bare && !ws.collision.given
        && sleep.rests_as_before(model, state)
        && all_same(&state.tree_asleep, &sleep.counters)
        && all_same(&state.pose_asleep, &sleep.pose)
        && all_blank(&state.qvel)
        && all_blank(&state.qacc_warmstart)
        && all_blank(&state.qfrc_applied)
        && are_occasional(state, all_blank)
        && (0..T::LANES).all(|lane| state.time.lane(lane).is_finite())
}

/// The number of values that are compared between tests of the result.
const BLOCK: usize = 256;

/// Returns true if two arrays hold equal numbers in all lanes.
#[inline(always)]
fn all_same<T: Real>(one: &[T], other: &[T]) -> bool {
    let same = |same: T::Mask, (a, b): (&T, &T)| same & a.eq(*b);
    let mut blocks = one.chunks(BLOCK).zip(other.chunks(BLOCK));
    blocks.all(|(a, b)| a.iter().zip(b).fold(T::Mask::splat(true), same).all())
}

/// Returns true if all bits of all numbers are zero.
#[inline(always)]
fn all_blank<T: Real>(numbers: &[T]) -> bool {
    let mut blocks = numbers.chunks(BLOCK);
    let and_blank = |blank: T::Mask, x: &T| blank & is_blank(*x);
    blocks.all(|block| block.iter().fold(T::Mask::splat(true), and_blank).all())
}

/// Returns true if a step only advances time: nothing is awake, nothing wakes, and the model has no actuators and no
/// past values. Mocap bodies must not have moved.
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
        // A pass first detects wakes by touch, and only among trees that are not yet awake.
        ws.sleep.begin(model, state);
        return false;
    }
    ws.sleep.rests_as_before(model, state) || (model.nmocap == 0 && !ws.read)
}

impl<T: Real> Sleep<T> {
    /// Invalidates all poses, so that the next pass computes them.
    pub fn invalidate(&mut self) {
        (self.placed, self.at_rest) = (false, false);
        if self.enabled {
            self.parts.clear();
            self.parts.push(0..self.bodies.len());
        }
    }

    /// Records a pass over a state.
    pub fn note(&mut self, model: &Model, state: &State<T>) {
        let (qpos, mocap) = self.pose.split_at_mut(model.nq);
        qpos.copy_from_slice(&state.qpos);
        for (m, pose) in mocap.chunks_exact_mut(7).enumerate() {
            pose.copy_from_slice(&mocap_pose(state, m));
        }
        self.placed = true;
        self.at_rest = self.all_asleep().all();
    }

    /// Returns the ranges of the bodies whose poses the position stage computes: all but those of trees on the world
    /// whose fixed poses are valid, or that sleep as in the last pass.
    pub fn parts<'a>(&'a self, fixed: &'a FixedPoses) -> &'a [Range<usize>] {
        match self.enabled {
            true => &self.parts,
            false => fixed.parts(),
        }
    }

    /// Computes [`parts`](Self::parts) for a state.
    pub(crate) fn find_parts(&mut self, model: &Model, state: &State<T>, fixed: &FixedPoses) {
        self.parts.clear();
        let mut trees = model.trees.iter().zip(&self.awake).peekable();
        for part in fixed.parts() {
            let mut start = part.start;
            while let Some((tree, awake)) = trees.next_if(|(tree, _)| tree.bodies.end <= part.end) {
                let apart = !awake.any() && model.bodies[tree.bodies.start].parent == 0;
                if apart && self.placed && self.lies_as_before(tree.qpos.clone(), state) {
                    if start < tree.bodies.start {
                        self.parts.push(start..tree.bodies.start);
                    }
                    start = tree.bodies.end;
                }
            }
            if start < part.end {
                self.parts.push(start..part.end);
            }
        }
    }

    /// Returns true if positions are those of the last pass.
    fn lies_as_before(&self, qpos: Range<usize>, state: &State<T>) -> bool {
        all_same(&self.pose[qpos.clone()], &state.qpos[qpos])
    }

    /// Returns true if all trees slept in the last pass at their present positions, and no mocap body has moved.
    fn rests_as_before(&self, model: &Model, state: &State<T>) -> bool {
        let mut mocap = self.pose[model.nq..].chunks_exact(7).enumerate();
        self.at_rest
            && self.lies_as_before(0..model.nq, state)
            && mocap.all(|(m, pose)| {
                (pose.iter().zip(&mocap_pose(state, m))).all(|(one, other)| one.eq(*other).all())
            })
    }
}
