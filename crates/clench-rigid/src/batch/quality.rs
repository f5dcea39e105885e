//! How well the steps of a batch went: what a run is judged by.

use crate::contact::Contact;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, kernel};
use clench_solver::Status;
use std::ops::AddAssign;

/// Sums and extremes over steps (and forward passes) of environments, but for those in which an environment failed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// Steps in which constraints acted.
    pub constrained: u64,
    /// Steps whose solve stopped at the iteration limit.
    pub unconverged: u64,
    /// Largest duality gap: how far a solution's cost may lie above the minimum.
    pub gap_max: f64,
    /// Most contacts.
    pub contacts_max: u64,
    /// Deepest penetration, m; 0 where nothing penetrates.
    pub penetration_max: f64,
}

impl Quality {
    /// Takes in the `good` ones of the first `len` lanes, in which environments are.
    pub(super) fn count<T: Real>(&mut self, ws: &Workspace<T>, len: usize, good: T::Mask) {
        let stats = ws.solver.stats();
        let (contacts, depth) = extent(&ws.contacts);
        for lane in (0..len).filter(|&lane| good.lane(lane)) {
            let status = stats.status(lane);
            let value = |x: T| x.lane(lane).to_f64();
            self.constrained += u64::from(status != Status::Unconstrained);
            self.unconverged += u64::from(status == Status::IterationLimit);
            self.gap_max = self.gap_max.max(value(stats.gap));
            self.contacts_max = self.contacts_max.max(value(contacts) as u64);
            self.penetration_max = self.penetration_max.max(value(depth));
        }
    }
}

/// How many contacts there are, and how deep the deepest is.
#[kernel]
fn extent<T: Real>(contacts: &[Contact<T>]) -> (T, T) {
    let (mut count, mut depth) = (T::ZERO, T::ZERO);
    for contact in contacts {
        count += T::select(contact.active, T::ONE, T::ZERO);
        depth = T::select(contact.active, -contact.dist, depth).max(depth);
    }
    (count, depth)
}

impl AddAssign for Quality {
    fn add_assign(&mut self, other: Self) {
        self.constrained += other.constrained;
        self.unconverged += other.unconverged;
        self.gap_max = self.gap_max.max(other.gap_max);
        self.contacts_max = self.contacts_max.max(other.contacts_max);
        self.penetration_max = self.penetration_max.max(other.penetration_max);
    }
}
