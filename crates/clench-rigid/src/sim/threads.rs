//! Threads that share the work of a step.

use super::{Sim, computed_state};
use crate::Precision;
use clench_dynamics::context::StepContext;
use clench_dynamics::error::SimError;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_solver::Threads;

/// The maximum number of threads.
const MAX_THREADS: usize = 1024;

impl<T: Precision> Sim<T> {
    /// Sets the number of threads that share each subsequent step and forward pass: pairs of geoms, islands, and the
    /// Hessian of a large island. Results are identical bit for bit. Threads pay off for scenes whose steps take a
    /// millisecond or more; for many environments use a [`Batch`](crate::Batch).
    ///
    /// # Errors
    /// Returns an error if `count` is 0 or more than 1024, or if the system cannot start the threads.
    pub fn set_threads(&mut self, count: usize) -> Result<(), SimError> {
        if !(1..=MAX_THREADS).contains(&count) {
            return Err(SimError::OutOfRange {
                field: "threads",
                value: count as f64,
                range: "1 to 1024",
            });
        }
        let threads = Threads::new(count).map_err(|e| SimError::Threads(e.to_string()))?;
        self.ws.set_threads(threads);
        Ok(())
    }

    /// Returns the number of threads of a step; 1 unless [`set_threads`](Self::set_threads) was called.
    pub fn threads(&self) -> usize {
        self.ws.threads.count()
    }

    /// Returns an error after a fork: the threads do not exist in the new process.
    pub(super) fn check_threads(&self) -> Result<(), SimError> {
        match self.ws.threads.are_lost() {
            true => Err(SimError::Forked),
            false => Ok(()),
        }
    }

    /// Runs a pass whose work the threads can share.
    pub(super) fn on_threads(
        &mut self,
        pass: impl FnOnce(
            StepContext<T::SingleEnv>,
            &mut State<T::SingleEnv>,
            &mut Workspace<T::SingleEnv>,
        ) + Send,
    ) {
        let context = T::context(&self.model, &self.params, &self.settings);
        let ws = &mut self.ws;
        let threads = ws.threads.clone();
        computed_state::change(&mut self.state, &mut self.lane_copy, |state| {
            threads.run_awake(|| pass(context, state, ws));
        });
    }
}
