//! Where the narrow phase spends its time, by kinds of pair; it counts and measures only while a profile is taken.

use crate::profile::PairProfile;
use clench_collide::ShapeKind;
use clench_solver::Stopwatch;
use std::time::Duration;

/// Kinds of shape; a pair of kinds has a number below its square.
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

    /// Runs if another does.
    pub(super) fn run_as(&mut self, other: &Self) {
        self.clock.run_as(&other.clock);
    }

    /// Takes what another has counted and measured.
    pub(super) fn absorb(&mut self, other: &mut Self) {
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

    /// A pair has been looked at in `lanes` environments and touches in those that `touching` counts.
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

    /// The kinds of pair that there were.
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
