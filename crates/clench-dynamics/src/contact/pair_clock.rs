//! The time of the narrow phase by kinds of pair, measured only while profiling.

use crate::profile::PairProfile;
use clench_collide::ShapeKind;
use clench_solver::Stopwatch;
use std::time::Duration;

/// The number of shape kinds; the index of a pair of kinds is below its square.
const KINDS: usize = ShapeKind::ALL.len();
const PAIRS: usize = KINDS * KINDS;

/// Counts and times pairs by kind.
#[derive(Clone, Debug)]
pub(crate) struct PairClock {
    clock: Stopwatch<PAIRS>,
    near: [u64; PAIRS],
    touching: [u64; PAIRS],
}

impl Default for PairClock {
    fn default() -> Self {
        PairClock {
            clock: Stopwatch::default(),
            near: [0; PAIRS],
            touching: [0; PAIRS],
        }
    }
}

impl PairClock {
    pub(crate) fn run(&mut self, running: bool) {
        self.clock.run(running);
    }

    /// Runs if `other` runs.
    pub(super) fn run_as(&mut self, other: &Self) {
        self.clock.run_as(&other.clock);
    }

    /// Moves the counts and times of `other`, if it runs, into this clock.
    #[inline]
    pub(super) fn absorb(&mut self, other: &mut Self) {
        if !other.clock.is_running() {
            return;
        }
        self.clock.absorb(&mut other.clock);
        for (mine, theirs) in [
            (&mut self.near, &mut other.near),
            (&mut self.touching, &mut other.touching),
        ] {
            for (mine, theirs) in mine.iter_mut().zip(theirs) {
                *mine += std::mem::take(theirs);
            }
        }
    }

    /// Starts the clock before the first pair.
    #[inline(always)]
    pub(super) fn start(&mut self) {
        self.clock.start();
    }

    /// Records a pair that was checked in `lanes` environments and touches in `touching` of them.
    #[inline(always)]
    pub(super) fn lap(
        &mut self,
        kinds: [ShapeKind; 2],
        lanes: usize,
        touching: impl Fn() -> usize,
    ) {
        if self.clock.is_running() {
            let pair = kinds[0] as usize * KINDS + kinds[1] as usize;
            self.near[pair] += lanes as u64;
            self.touching[pair] += touching() as u64;
            self.clock.lap(pair);
        }
    }

    /// Returns the kinds of pair that occurred.
    pub(crate) fn profiles(&self) -> Vec<PairProfile> {
        let all = ShapeKind::ALL.into_iter();
        let kinds = all.flat_map(|a| ShapeKind::ALL.into_iter().map(move |b| [a, b]));
        let counts = self.near.iter().zip(&self.touching);
        let rows = kinds.zip(counts.zip(self.clock.spent()));
        let profile = |(kinds, ((&near, &touching), &time)): (_, (_, &Duration))| PairProfile {
            kinds,
            near,
            touching,
            time,
        };
        rows.map(profile).filter(|pair| pair.near > 0).collect()
    }
}
