//! Sleeping islands: trees at rest are excluded from the step until something wakes them.
//!
//! Each tree has a counter, as MuJoCo's `tree_asleep`. While awake, it counts steps of small velocity, from [`AWAKE`]
//! up to `READY`. When all trees of an island are ready, their velocities become zero and the counters a cycle through
//! the island: each is the index of the next tree. `docs/sleeping.md` has the rules, `wake.rs` wakes trees and
//! `fall.rs` deactivates them.
//!
//! A tree that sleeps in a lane keeps its positions there. Constraints and contacts that act only on sleeping and fixed
//! bodies are absent. A constraint between a sleeping and an awake tree wakes the former before it acts. So sleep in
//! one lane does not affect the others.

mod fall;
mod parts;
mod skipped_work;
mod wake;

pub use fall::fall_asleep;
pub(crate) use fall::{restore_sleeping, stop_sleeping};
pub(crate) use skipped_work::{is_idle, sleeps_unchanged};
pub use wake::wake_in_state;
pub(crate) use wake::{wake_coupled, wake_pulled, wake_touched, wake_touching};

use crate::model::Model;
use crate::state::State;
use clench_math::{Mask, Quat, Real, Scalar, Vec3};
use clench_solver::Partition;
pub(crate) use parts::Parts;

/// The counter of a moving tree; it reaches `READY` after 10 steps below the tolerance (MuJoCo's `mjMINAWAKE`).
pub const AWAKE: f64 = -11.0;
/// The counter of a tree that has been slow for long enough.
pub const READY: f64 = -1.0;

/// The sleep state of the trees in a step.
#[derive(Clone, Debug)]
pub struct Sleep<T: Real> {
    /// True if any tree can sleep; the other fields are unused otherwise.
    enabled: bool,
    /// The counters of the trees, written to [`State::tree_asleep`] after the step.
    counters: Vec<T>,
    /// Lanes in which each tree is awake.
    awake: Vec<T::Mask>,
    /// Lanes in which each body is awake: mocap bodies always, because the user may move them, and fixed bodies never.
    bodies: Vec<T::Mask>,
    /// True if the workspace's results are those of a complete pass at the positions in `pose`.
    has_results: bool,
    /// The positions, and the poses of mocap bodies, of the last complete pass.
    pose: Vec<T>,
    /// True if, in addition, all trees slept in the last pass in all lanes.
    at_rest: bool,
    parts: Parts,
    partition: Partition<T>,
    /// Scratch: the trees of an island.
    members: Vec<u32>,
}

impl<T: Real> Sleep<T> {
    /// Creates the record with everything awake.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub fn new(model: &Model) -> Self {
        let enabled = model.may_sleep();
        let numbers = |of_model: usize| if enabled { of_model } else { 0 };
        Sleep {
            enabled,
            counters: vec![T::new(AWAKE); numbers(model.ntree())],
            awake: vec![T::Mask::splat(true); numbers(model.ntree())],
            bodies: (0..numbers(model.nbody()))
                .map(|body| T::Mask::splat(!model.is_fixed(body)))
                .collect(),
            at_rest: false,
            has_results: false,
            parts: Parts::new(model),
            pose: vec![T::ZERO; numbers(model.nq + 7 * model.nmocap)],
            partition: Partition::default(),
            members: Vec::new(),
        }
    }

    /// Returns the counters of the trees.
    pub fn counters(&self) -> &[T] {
        &self.counters
    }

    /// Starts from the counters of a state.
    pub fn begin(&mut self, model: &Model, state: &State<T>) {
        self.counters.copy_from_slice(&state.tree_asleep);
        self.update(model);
    }

    /// Updates the awake lanes from the counters.
    fn update(&mut self, model: &Model) {
        for (t, counter) in self.counters.iter().enumerate() {
            let awake = counter.lt(T::ZERO);
            self.awake[t] = awake;
            self.bodies[model.trees[t].bodies.clone()].fill(awake);
            self.parts.set_awake(t, awake.any());
        }
    }

    /// Returns the trees that are awake in any lane.
    pub(crate) fn trees(&self) -> &Parts {
        &self.parts
    }

    /// Returns the lanes in which a tree is awake.
    #[inline(always)]
    pub(crate) fn is_awake(&self, tree: usize) -> T::Mask {
        match self.enabled {
            true => self.awake[tree],
            false => T::Mask::splat(true),
        }
    }

    /// Returns the lanes in which constraints between two bodies act, because either is awake.
    #[inline(always)]
    pub(crate) fn is_either_awake(&self, [first, second]: [usize; 2]) -> T::Mask {
        match self.enabled {
            true => self.bodies[first] | self.bodies[second],
            false => T::Mask::splat(true),
        }
    }

    /// Returns true if all trees slept in the last pass, at the positions that it stored.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// Returns the lanes in which everything sleeps.
    pub fn all_asleep(&self) -> T::Mask {
        let nothing = T::Mask::splat(!self.awake.is_empty());
        (self.awake.iter()).fold(nothing, |asleep, &awake| asleep & !awake)
    }

    /// Returns the lowest tree of the island with which a tree sleeps in a lane.
    fn first_of_island(&self, tree: usize, lane: usize) -> usize {
        let mut lowest = tree;
        self.each_of_island(tree, lane, |at| lowest = lowest.min(at));
        lowest
    }

    /// Passes the trees of the island with which a tree sleeps in a lane to `show`. Counters that users wrote may not
    /// form a cycle; then it passes some of the trees and terminates.
    fn each_of_island(&self, tree: usize, lane: usize, mut show: impl FnMut(usize)) {
        let mut at = tree;
        for _ in 0..self.counters.len() {
            let next = self.counters[at].lane(lane).to_f64();
            if next < 0.0 {
                return;
            }
            show(at);
            at = next as usize;
            if at == tree || at >= self.counters.len() {
                return;
            }
        }
    }
}

/// Returns the lanes in which all bits of a number are zero. Users write −0 to wake trees without moving them.
#[inline(always)]
fn is_blank<T: Real>(x: T) -> T::Mask {
    x.eq(T::ZERO) & T::ONE.copysign(x).gt(T::ZERO)
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

/// Returns the pose of a mocap body in the layout of [`State::pose_asleep`].
fn mocap_pose<T: Real>(state: &State<T>, mocap: usize) -> [T; 7] {
    let (Vec3 { x, y, z }, turn) = (state.mocap_pos[mocap], state.mocap_quat[mocap]);
    let Quat {
        w,
        x: i,
        y: j,
        z: k,
    } = turn;
    [x, y, z, w, i, j, k]
}
