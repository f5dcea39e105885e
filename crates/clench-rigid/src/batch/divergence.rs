//! Divergence of the environments of a group: the loss of lane utilization.

use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar};
use std::ops::AddAssign;
use std::slice::from_ref;

/// Sums over steps (and forward passes) of groups that measure the loss to divergence, including those in which an
/// environment failed. A group iterates until the last of its environments converges, and has a slot for every contact
/// of any of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Divergence {
    /// The number of group steps.
    pub group_steps: u64,
    /// The number of environment steps.
    pub env_steps: u64,
    /// The lanes of the group steps, including idle ones.
    pub lane_steps: u64,
    /// Solver iterations of groups.
    pub group_iterations: u64,
    /// Solver iterations required by environments.
    pub env_iterations: u64,
    /// Lanes times solver iterations of groups.
    pub lane_iterations: u64,
    /// Contact slots of groups.
    pub contact_slots: u64,
    /// Contacts of environments.
    pub contacts: u64,
}

impl Divergence {
    /// Returns the fraction of lanes that are active in a solver iteration; 1 without iterations.
    pub fn live_share(&self) -> f64 {
        match self.lane_iterations {
            0 => 1.0,
            lanes => self.env_iterations as f64 / lanes as f64,
        }
    }
    /// Returns the mean number of solver iterations of a group.
    pub fn iterations_per_group(&self) -> f64 {
        ratio(self.group_iterations, self.group_steps)
    }
    /// Returns the mean number of solver iterations of an environment.
    pub fn iterations_per_env(&self) -> f64 {
        ratio(self.env_iterations, self.env_steps)
    }
    /// Returns the mean number of contact slots of a group.
    pub fn slots_per_group(&self) -> f64 {
        ratio(self.contact_slots, self.group_steps)
    }
    /// Returns the mean number of contacts of an environment.
    pub fn contacts_per_env(&self) -> f64 {
        ratio(self.contacts, self.env_steps)
    }

    /// Adds a step of a group whose environments are in the first `len` lanes.
    pub(super) fn count<T: Real>(&mut self, ws: &Workspace<T>, len: usize) {
        let iterations = &T::as_scalars(from_ref(&ws.solver.stats().iterations))[..len];
        let iterations = iterations.iter().map(|x| x.to_f64() as u64);
        let max_iterations = iterations.clone().max().unwrap_or(0);
        self.group_steps += 1;
        self.env_steps += len as u64;
        self.lane_steps += T::LANES as u64;
        self.group_iterations += max_iterations;
        self.env_iterations += iterations.sum::<u64>();
        self.lane_iterations += max_iterations * T::LANES as u64;
        self.contact_slots += ws.contacts.len() as u64;
        for contact in &ws.contacts {
            let active = (0..len).filter(|&lane| contact.active.lane(lane));
            self.contacts += active.count() as u64;
        }
    }
}

impl AddAssign for Divergence {
    fn add_assign(&mut self, other: Self) {
        self.group_steps += other.group_steps;
        self.env_steps += other.env_steps;
        self.lane_steps += other.lane_steps;
        self.group_iterations += other.group_iterations;
        self.env_iterations += other.env_iterations;
        self.lane_iterations += other.lane_iterations;
        self.contact_slots += other.contact_slots;
        self.contacts += other.contacts;
    }
}

fn ratio(a: u64, b: u64) -> f64 {
    if b == 0 { 0.0 } else { a as f64 / b as f64 }
}
