//! The environments in a stepper's lanes.

use clench_math::{Mask, Real};
use std::marker::PhantomData;

/// The maximum number of lanes of any instruction set.
pub(super) const MAX_LANES: usize = 16;

/// The environments in the first `len` lanes.
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

    /// Returns each environment with its lane.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.len).map(|lane| (lane, self.envs[lane] as usize))
    }

    /// Returns every lane with an environment; unused lanes repeat the last one.
    pub fn fill(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..T::LANES).map(|lane| (lane, self.envs[lane.min(self.len - 1)] as usize))
    }

    /// Removes the environments outside these lanes.
    pub fn retain(&mut self, lanes: T::Mask) {
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
