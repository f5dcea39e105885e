//! The environments that lie side by side in a stepper's lanes.

use clench_math::{Mask, Real};
use std::marker::PhantomData;

/// The most lanes that any instruction set has.
pub(super) const MAX_LANES: usize = 16;

/// The environments in the lanes, the first `len` of them.
pub struct Group<T> {
    envs: [u32; MAX_LANES],
    pub len: usize,
    lanes: PhantomData<T>,
}

impl<T: Real> Group<T> {
    pub fn new(envs: &[u32]) -> Self {
        const { assert!(T::LANES <= MAX_LANES) };
        let mut group = Group {
            envs: [0; MAX_LANES],
            len: envs.len().min(T::LANES),
            lanes: PhantomData,
        };
        group.envs[..group.len].copy_from_slice(&envs[..group.len]);
        group
    }

    /// Each environment with its lane.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.len).map(|lane| (lane, self.envs[lane] as usize))
    }

    /// Every lane with an environment: those left over repeat the last.
    pub fn fill(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..T::LANES).map(|lane| (lane, self.envs[lane.min(self.len - 1)] as usize))
    }

    /// Keeps the environments of some lanes.
    pub fn keep(&mut self, lanes: T::Mask) {
        let mut kept = 0;
        for lane in 0..self.len {
            if lanes.lane(lane) {
                self.envs[kept] = self.envs[lane];
                kept += 1;
            }
        }
        self.len = kept;
    }
}
