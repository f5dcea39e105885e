//! Options of a batch.

use clench_dynamics::error::SimError;
use clench_dynamics::options::RigidOptions;
use clench_math::{Instructions, Scalar};
use clench_solver::Threads;
use std::thread::available_parallelism;

/// The fixed cost of a group step; `LANE_COST` is the cost per lane in the same unit. Groups of 1, 4 and 8 environments
/// of a humanoid take times in the ratio 3.5 : 6.5 : 10.5 (measured).
const GROUP_COST: usize = 5;
const LANE_COST: usize = 2;

/// Options of a batch. Only [`options`](Self::options) affects the results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchOptions {
    /// Options that override those of the model.
    pub options: RigidOptions,
    /// The instruction set, and so the number of lanes; by default the fastest for the batch.
    pub instructions: Option<Instructions>,
    /// The number of threads, at most one per environment; by default one per processor.
    pub threads: Option<usize>,
    /// True if environments with similar contacts are grouped, which makes steps faster; by default true.
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
            None => fastest::<S>(count, threads).ok_or(SimError::Instructions(S::SINGLE_ENV)),
        }
    }
}

/// Returns the fastest available instructions for `count` environments, if there are any. Few environments do not fill
/// wide lanes on all threads.
fn fastest<S: Scalar>(count: usize, threads: usize) -> Option<Instructions> {
    let time = |instructions: &Instructions| {
        let lanes = instructions.lanes::<S>();
        let rounds = count.div_ceil(lanes).div_ceil(threads);
        rounds * (GROUP_COST + LANE_COST * lanes)
    };
    let widest_first = Instructions::all_available::<S>().rev();
    widest_first.min_by_key(time)
}
