//! Deactivation: trees fall asleep and keep their positions.
//!
//! A tree is slow if each of its velocities, times the length of its dof, is below the tolerance, and no force is
//! applied to it. The velocity at the start of the step counts, as in MuJoCo: a step in which an island falls asleep
//! does not move it.

use super::wake::is_free;
use super::{AWAKE, READY, Sleep, is_blank, mocap_pose};
use crate::context::StepContext;
use crate::model::{KinematicTree, Model, Params, SleepPolicy};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, kernel};
use clench_solver::{Problem, Switch};

/// Counts the steps in which trees are slow, and deactivates the islands whose trees have all been slow for long
/// enough: their velocities and accelerations become zero. The islands follow from the constraints of `ws`.
#[kernel]
pub fn fall_asleep<T: Real>(context: StepContext<T>, state: &mut State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    let sleep = &mut ws.sleep;
    // Without islands, trees fall asleep only in lanes without constraints, as in MuJoCo.
    let counting = match settings.solver.islands {
        Switch::Off => !constrained(&ws.problem),
        Switch::Auto | Switch::On => T::Mask::splat(true),
    };
    let mut ready = T::Mask::splat(false);
    for (t, tree) in model.trees.iter().enumerate() {
        let counts = counting & sleep.awake[t];
        if !counts.any() {
            continue;
        }
        let counter = sleep.counters[t];
        let next = (counter.max(T::new(AWAKE)) + T::ONE).min(T::new(READY));
        let next = T::select(is_slow(params, tree, state), next, T::new(AWAKE));
        sleep.counters[t] = T::select(counts, next, counter);
        ready |= counts & next.eq(T::new(READY));
    }
    if ready.any() {
        deactivate_islands(model, state, &ws.problem, counting, sleep, &mut ws.qacc);
    }
}

/// Returns the lanes in which any constraint acts.
fn constrained<T: Real>(problem: &Problem<T>) -> T::Mask {
    let rows = problem.blocks().flat_map(|block| block.d);
    rows.fold(T::Mask::splat(false), |lanes, d| lanes | d.gt(T::ZERO))
}

/// Returns the lanes in which a tree may sleep, is slow and has no applied force.
#[inline(always)]
fn is_slow<T: Real>(params: &Params<T>, tree: &KinematicTree, state: &State<T>) -> T::Mask {
    let mut slow = T::Mask::splat(tree.sleep != SleepPolicy::Never);
    let tolerance = params.sleep_tolerance;
    for i in tree.dofs.clone() {
        let speed = params.dof_length[i] * state.qvel[i].abs();
        slow &= speed.lt(tolerance) | (tolerance.eq(T::ZERO) & is_blank(state.qvel[i]));
    }
    slow & is_free(tree, state)
}

/// Deactivates ready islands as a whole, and ready trees on which no constraint acts.
#[inline(always)]
fn deactivate_islands<T: Real>(
    model: &Model,
    state: &mut State<T>,
    problem: &Problem<T>,
    lanes: T::Mask,
    sleep: &mut Sleep<T>,
    qacc: &mut [T],
) {
    let mut partition = std::mem::take(&mut sleep.partition);
    let mut members = std::mem::take(&mut sleep.members);
    partition.find(problem);
    for island in partition.islands() {
        members.clear();
        members.extend_from_slice(partition.trees(island));
        members.sort_unstable();
        let is_ready = |&tree: &u32| sleep.counters[tree as usize].eq(T::new(READY));
        let ready = (members.iter().map(is_ready)).fold(lanes & island.lanes, |all, one| all & one);
        if ready.any() {
            deactivate(model, state, sleep, &members, ready, qacc);
        }
    }
    for tree in 0..model.ntree() {
        let unconstrained = lanes & !partition.constrained(tree);
        let ready = unconstrained & sleep.counters[tree].eq(T::new(READY));
        if ready.any() {
            deactivate(model, state, sleep, &[tree as u32], ready, qacc);
        }
    }
    sleep.partition = partition;
    sleep.members = members;
    sleep.update(model);
}

/// Deactivates the trees of an island in some lanes.
#[inline(always)]
fn deactivate<T: Real>(
    model: &Model,
    state: &mut State<T>,
    sleep: &mut Sleep<T>,
    members: &[u32],
    lanes: T::Mask,
    qacc: &mut [T],
) {
    for (k, &tree) in members.iter().enumerate() {
        let next = members[(k + 1) % members.len()];
        let counter = &mut sleep.counters[tree as usize];
        *counter = T::select(lanes, T::new(f64::from(next)), *counter);
        let tree = &model.trees[tree as usize];
        for i in tree.dofs.clone() {
            state.qvel[i] = T::select(lanes, T::ZERO, state.qvel[i]);
            qacc[i] = T::select(lanes, T::ZERO, qacc[i]);
        }
        for q in tree.qpos.clone() {
            state.pose_asleep[q] = T::select(lanes, state.qpos[q], state.pose_asleep[q]);
        }
    }
}

impl<T: Real> Sleep<T> {
    /// Sets the acceleration of sleeping trees to zero.
    #[kernel]
    pub fn clear_sleeping(&self, model: &Model, qacc: &mut [T]) {
        for (tree, &awake) in model.trees.iter().zip(&self.awake) {
            if awake.all() {
                continue;
            }
            for qacc in &mut qacc[tree.dofs.clone()] {
                *qacc = T::select(awake, *qacc, T::ZERO);
            }
        }
    }
}

/// Sets the velocities (nv) of sleeping trees to zero, whatever acceleration the integrator has found for them.
#[kernel]
pub fn stop_sleeping<T: Real>(model: &Model, sleep: &Sleep<T>, qvel: &mut [T]) {
    for (tree, &awake) in model.trees.iter().zip(&sleep.awake) {
        if awake.all() {
            continue;
        }
        for qvel in &mut qvel[tree.dofs.clone()] {
            *qvel = T::select(awake, *qvel, T::ZERO);
        }
    }
}

/// Stores in the state which trees sleep, and resets those to their sleeping positions, independently of the
/// integrator.
#[kernel]
pub fn restore_sleeping<T: Real>(model: &Model, state: &mut State<T>, ws: &Workspace<T>) {
    state.tree_asleep.copy_from_slice(&ws.sleep.counters);
    for (tree, &awake) in model.trees.iter().zip(&ws.sleep.awake) {
        if awake.all() {
            continue;
        }
        for q in tree.qpos.clone() {
            state.qpos[q] = T::select(awake, state.qpos[q], state.pose_asleep[q]);
        }
    }
    for mocap in 0..model.nmocap {
        let pose = mocap_pose(state, mocap);
        let start = model.nq + 7 * mocap;
        state.pose_asleep[start..start + 7].copy_from_slice(&pose);
    }
}
