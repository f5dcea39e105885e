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
mod idle;
mod wake;

pub use fall::fall_asleep;
pub(crate) use fall::hold;
pub(crate) use idle::{is_idle, rests};
pub use wake::wake_in_state;
pub(crate) use wake::{wake_coupled, wake_pulled, wake_touched, wake_touching};

use crate::model::Model;
use crate::state::State;
use clench_math::{Mask, Quat, Real, Scalar, Vec3};
use clench_solver::Partition;
use std::ops::Range;

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
    /// True if the workspace's results are those of the positions and mocap poses in `pose`.
    placed: bool,
    pose: Vec<T>,
    /// True if, in addition, all trees slept in the last pass in all lanes.
    at_rest: bool,
    /// Ranges of the bodies whose poses the position stage computes.
    parts: Vec<Range<usize>>,
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
        let awake = |of_model: usize| vec![T::Mask::splat(true); numbers(of_model)];
        Sleep {
            enabled,
            counters: vec![T::new(AWAKE); numbers(model.ntree())],
            awake: awake(model.ntree()),
            bodies: awake(model.nbody()),
            at_rest: false,
            placed: false,
            parts: std::iter::once(0..model.nbody()).collect(),
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
        for (awake, counter) in self.awake.iter_mut().zip(&self.counters) {
            *awake = counter.lt(T::ZERO);
        }
        for (body, awake) in self.bodies.iter_mut().enumerate() {
            *awake = match model.tree_of_body(body) {
                Some(tree) => self.awake[tree],
                None => {
                    let weld = model.bodies[body].weld;
                    T::Mask::splat(model.bodies[weld].mocap.is_some())
                }
            };
        }
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
