//! The causes that wake sleeping trees, in the order in which a step tests for them.
//!
//! A tree wakes with its whole island. A tree that the user or an equality wakes restarts its counter. A tree that
//! is touched or pulled takes the counter of the tree that wakes it, because both must be at rest to sleep again.

use super::{AWAKE, Sleep, all_blank, is_blank, mocap_pose};
use crate::context::StepContext;
use crate::model::{Coupled, KinematicTree, Model, SleepPolicy};
use crate::state::State;
use crate::state::slots::each_tie;
use crate::workspace::Workspace;
use clench_math::{Force, Mask, Real, Scalar, kernel};

impl<T: Real> Sleep<T> {
    /// Wakes the island of a tree in some lanes, with `counter` for each of its trees. In lanes where the tree is
    /// awake, it takes `counter` if that is further from sleep.
    fn wake(&mut self, tree: usize, lanes: T::Mask, counter: T) {
        for lane in (0..T::LANES).filter(|&lane| lanes.lane(lane)) {
            let counter = counter.lane(lane);
            let now = self.counters[tree].lane(lane);
            if now < T::Scalar::ZERO {
                self.counters[tree].set_lane(lane, if counter < now { counter } else { now });
                continue;
            }
            self.members.clear();
            let mut members = std::mem::take(&mut self.members);
            self.each_of_island(tree, lane, |at| members.push(at as u32));
            for &at in &members {
                self.counters[at as usize].set_lane(lane, counter);
            }
            self.members = members;
        }
    }

    /// Wakes each of two trees where it sleeps and the other does not. Returns true if any was asleep.
    fn wake_each_other(&mut self, [one, other]: [usize; 2], lanes: T::Mask) -> bool {
        let mut woke = false;
        for [asleep, awake] in [[one, other], [other, one]] {
            let wakes = lanes & !self.awake[asleep] & self.awake[awake];
            if wakes.any() {
                self.wake(asleep, wakes, self.counters[awake]);
                woke = true;
            }
        }
        woke
    }
}

/// Starts from the state, and wakes trees that the user changed: trees whose positions differ from those at which they
/// fell asleep, including those moved by a mocap body, and trees with velocities or applied forces.
#[kernel]
pub(crate) fn wake_touched<T: Real>(model: &Model, state: &State<T>, ws: &mut Workspace<T>) {
    let sleep = &mut ws.sleep;
    sleep.begin(model, state);
    let forces = !(all_blank(&state.qfrc_applied) && no_wrench(&state.xfrc_applied).all());
    for (t, tree) in model.trees.iter().enumerate() {
        let asleep = !sleep.awake[t];
        if !asleep.any() {
            continue;
        }
        let mut untouched = is_untouched(model, tree, state);
        if forces {
            untouched &= is_free(tree, state);
        }
        let touched = asleep & !untouched;
        // Another tree of the island may have woken it.
        let touched = touched & sleep.counters[t].ge(T::ZERO);
        if touched.any() {
            sleep.wake(t, touched, T::new(AWAKE));
        }
    }
    sleep.update(model);
}

/// Returns the lanes in which a sleeping tree is as it fell asleep, apart from the forces on it.
#[inline(always)]
fn is_untouched<T: Real>(model: &Model, tree: &KinematicTree, state: &State<T>) -> T::Mask {
    let mut same = T::Mask::splat(tree.sleep != SleepPolicy::Never);
    let asleep = &state.pose_asleep[tree.qpos.clone()];
    for (q, &asleep) in state.qpos[tree.qpos.clone()].iter().zip(asleep) {
        same &= q.eq(asleep);
    }
    if let Some(mocap) = tree.mocap {
        let stored = &state.pose_asleep[model.nq + 7 * mocap..];
        for (x, &stored) in mocap_pose(state, mocap).into_iter().zip(stored) {
            same &= x.eq(stored);
        }
    }
    for &v in &state.qvel[tree.dofs.clone()] {
        same &= is_blank(v);
    }
    same
}

/// Returns the lanes in which the user applies no force to a tree.
#[inline(always)]
pub(super) fn is_free<T: Real>(tree: &KinematicTree, state: &State<T>) -> T::Mask {
    let mut free = T::Mask::splat(true);
    for &force in &state.qfrc_applied[tree.dofs.clone()] {
        free &= is_blank(force);
    }
    free & no_wrench(&state.xfrc_applied[tree.bodies.clone()])
}

/// Returns the lanes in which all bits of some forces are zero.
#[inline(always)]
fn no_wrench<T: Real>(forces: &[Force<T>]) -> T::Mask {
    let mut blank = T::Mask::splat(true);
    for force in forces {
        for part in [force.linear, force.angular] {
            blank &= is_blank(part.x) & is_blank(part.y) & is_blank(part.z);
        }
    }
    blank
}

/// Wakes trees by tendons that connect them to others, if such a tendon is at a limit or has dry friction. Returns true
/// if there were any.
#[kernel]
pub(crate) fn wake_pulled<T: Real>(context: StepContext<T>, ws: &mut Workspace<T>) -> bool {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    if !settings.flags.constraint {
        return false;
    }
    let sleep = &mut ws.sleep;
    let mut woke = false;
    for (t, tendon) in model.tendons.iter().enumerate() {
        let Some(trees) = model.tendon_ties[t] else {
            continue;
        };
        let mut pulls = T::Mask::splat(false);
        if tendon.limited && settings.flags.limit {
            let (length, [low, high]) = (ws.position.ten_length[t], params.tendon_range[t]);
            let margin = params.tendon_margin[t];
            pulls |= (length - low).lt(margin) | (high - length).lt(margin);
        }
        if tendon.frictionloss && settings.flags.frictionloss {
            pulls |= params.tendon_frictionloss[t].gt(T::ZERO);
        }
        woke |= sleep.wake_each_other(trees, pulls);
    }
    if woke {
        sleep.update(model);
    }
    woke
}

/// Wakes trees in contact with awake trees or mocap bodies. Returns true if there were any. Contact detection must then
/// run again, because contacts among the woken trees and with fixed bodies are missing.
#[kernel]
pub(crate) fn wake_touching<T: Real>(model: &Model, ws: &mut Workspace<T>) -> bool {
    let sleep = &mut ws.sleep;
    let mut woke = false;
    for contact in &ws.contacts {
        let bodies = contact.geoms.map(|geom| model.geoms[geom].body);
        woke |= wake_pair(model, sleep, bodies, contact.active);
    }
    if woke {
        sleep.update(model);
    }
    woke
}

/// Wakes either of two bodies by the other. Returns true if any slept.
#[inline(always)]
fn wake_pair<T: Real>(
    model: &Model,
    sleep: &mut Sleep<T>,
    bodies: [usize; 2],
    lanes: T::Mask,
) -> bool {
    match bodies.map(|body| model.tree_of_body(body)) {
        [Some(one), Some(other)] => one != other && sleep.wake_each_other([one, other], lanes),
        [Some(tree), None] => wake_by_body(sleep, tree, bodies[1], lanes),
        [None, Some(tree)] => wake_by_body(sleep, tree, bodies[0], lanes),
        [None, None] => false,
    }
}

/// Wakes a tree by a body without joints, if a mocap body carries that. Returns true if the tree slept.
#[inline(always)]
fn wake_by_body<T: Real>(sleep: &mut Sleep<T>, tree: usize, body: usize, lanes: T::Mask) -> bool {
    let wakes = lanes & !sleep.awake[tree] & sleep.bodies[body];
    if wakes.any() {
        sleep.wake(tree, wakes, T::new(AWAKE));
    }
    wakes.any()
}

/// Wakes trees that an active equality, or a constraint added at run time, couples to an awake tree, to a mocap body,
/// or to a tree that sleeps in another island (the equality was off when they fell asleep). Returns true if there were
/// any.
#[kernel]
pub fn wake_coupled<T: Real>(model: &Model, state: &State<T>, ws: &mut Workspace<T>) -> bool {
    let sleep = &mut ws.sleep;
    let mut woke = false;
    for (equality, &active) in model.equalities.iter().zip(&state.eq_active) {
        if !active.any() {
            continue;
        }
        let of_joint = |joint: usize| Some(model.tree.tree_of(model.joints[joint].dof));
        match equality.target.coupled() {
            Coupled::Points(bodies) | Coupled::Frames(bodies) => {
                woke |= wake_bodies(model, sleep, bodies, active);
            }
            Coupled::Joints(follower, leader) => {
                if let [Some(one), Some(other)] = [of_joint(follower), leader.and_then(of_joint)] {
                    woke |= wake_couple(sleep, [one, other], active);
                }
            }
            Coupled::Tendons(follower, leader) => {
                let tendons = [Some(follower), leader].into_iter().flatten();
                let mut dofs = tendons.flat_map(|tendon| model.tendon_dofs.dofs(tendon));
                if let Some(&first) = dofs.next() {
                    let tree_of = |dof: u32| model.tree.tree_of(dof as usize);
                    for &other in dofs {
                        woke |= wake_couple(sleep, [tree_of(first), tree_of(other)], active);
                    }
                }
            }
        }
    }
    for slot in 0..state.dynamic_kind.len() {
        each_tie(model, state, slot, |tie| {
            woke |= wake_bodies(model, sleep, tie.bodies, tie.lanes);
        });
    }
    if woke {
        sleep.update(model);
    }
    woke
}

/// Wakes the bodies of a connect or weld. Returns true if any slept.
#[inline(always)]
fn wake_bodies<T: Real>(
    model: &Model,
    sleep: &mut Sleep<T>,
    bodies: [usize; 2],
    lanes: T::Mask,
) -> bool {
    match bodies.map(|body| model.tree_of_body(body)) {
        [Some(one), Some(other)] => wake_couple(sleep, [one, other], lanes),
        _ => wake_pair(model, sleep, bodies, lanes),
    }
}

/// Wakes both of two trees in the lanes in which they do not sleep in the same island. Returns true if any slept.
#[inline(always)]
fn wake_couple<T: Real>(sleep: &mut Sleep<T>, trees: [usize; 2], lanes: T::Mask) -> bool {
    let [one, other] = trees;
    if one == other {
        return false;
    }
    let mut woke = false;
    let asleep = lanes & !(sleep.awake[one] & sleep.awake[other]);
    for lane in (0..T::LANES).filter(|&lane| asleep.lane(lane)) {
        let both = !sleep.awake[one].lane(lane) && !sleep.awake[other].lane(lane);
        if both && sleep.first_of_island(one, lane) == sleep.first_of_island(other, lane) {
            continue;
        }
        let mut this_lane = T::Mask::splat(false);
        this_lane.set_lane(lane, true);
        for tree in trees {
            if !sleep.awake[tree].lane(lane) {
                sleep.wake(tree, this_lane, T::new(AWAKE));
            }
        }
        woke = true;
    }
    woke
}

/// Wakes, in a state itself, the islands of two bodies when a constraint between them is added or removed.
pub fn wake_in_state<T: Scalar>(model: &Model, state: &mut State<T>, bodies: [usize; 2]) {
    for tree in bodies
        .into_iter()
        .filter_map(|body| model.tree_of_body(body))
    {
        let mut at = tree;
        // Sleeping trees name the next of their island, in a cycle. In a state that was written by hand it may not
        // close.
        for _ in 0..state.tree_asleep.len() {
            let next = state.tree_asleep[at];
            state.tree_asleep[at] = T::new(AWAKE);
            let next = next.to_f64();
            if next < 0.0 || next >= state.tree_asleep.len() as f64 {
                break;
            }
            at = next as usize;
        }
    }
}
