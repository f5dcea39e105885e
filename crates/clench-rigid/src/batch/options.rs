//! How a batch is stepped.

use clench_dynamics::error::SimError;
use clench_dynamics::options::RigidOptions;
use clench_math::{Instructions, Scalar};
use clench_solver::Threads;
use std::thread::available_parallelism;

/// What a step of a group costs beside its lanes, in units of what a lane adds: groups of 1, 4 and 8 environments of a
/// humanoid were measured to take times like 3.5, 6.5 and 10.5.
const GROUP_COST: usize = 5;
const LANE_COST: usize = 2;

/// How a batch is stepped. Only [`options`](Self::options) changes what comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchOptions {
    /// Options that go before those of the model.
    pub options: RigidOptions,
    /// How environments lie side by side; by default as suits their number and the processor.
    pub instructions: Option<Instructions>,
    /// How many threads step, but no more than there are environments; by default as many as there are processors.
    pub threads: Option<usize>,
    /// Whether environments of like contacts are put side by side, which makes steps faster; by default they are.
    pub grouping: bool,
}

impl Default for BatchOptions {
    fn default() -> Self {
        BatchOptions {
            options: RigidOptions::new(),
            instructions: None,
            threads: None,
            grouping: true,
        }
    }
}

impl BatchOptions {
    pub(super) fn threads(&self, count: usize) -> Result<Threads, SimError> {
        let threads = match self.threads {
            Some(0) => {
                return Err(SimError::OutOfRange {
                    field: "threads",
                    value: 0.0,
                    range: "at least 1",
                });
            }
            Some(threads) => threads,
            None => available_parallelism().map_or(1, usize::from),
        };
        Threads::new(threads.min(count.max(1))).map_err(|e| SimError::Threads(e.to_string()))
    }

    pub(super) fn instructions<S: Scalar>(
        &self,
        count: usize,
        threads: usize,
    ) -> Result<Instructions, SimError> {
        match self.instructions {
            Some(chosen) if !chosen.available_for::<S>() => Err(SimError::Instructions(chosen)),
            Some(chosen) => Ok(chosen),
            None => fastest::<S>(count, threads).ok_or(SimError::Instructions(S::ALONE)),
        }
    }
}

/// The instructions by which `count` environments are done soonest, if there are any: few environments do not fill wide lanes on all
/// threads.
fn fastest<S: Scalar>(count: usize, threads: usize) -> Option<Instructions> {
    let time = |instructions: &Instructions| {
        let lanes = instructions.lanes::<S>();
        let rounds = count.div_ceil(lanes).div_ceil(threads);
        rounds * (GROUP_COST + LANE_COST * lanes)
    };
    let widest_first = Instructions::all_available::<S>().rev();
    widest_first.min_by_key(time)
}
