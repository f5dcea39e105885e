//! The derivatives of every environment of a batch.

use crate::{Linearization, Linearizer, Request};
use clench_rigid::{Batch, Sim, SimError};
use std::fmt;
use std::sync::Mutex;

/// Computes the derivatives of a batch on as many threads as the batch has, and reuses its memory.
pub struct BatchLinearizer {
    workers: Vec<Worker>,
    results: Vec<Linearization>,
}

/// The memory of a thread, which serves its environments in turn.
struct Worker {
    sim: Sim<f64>,
    linearizer: Linearizer,
}

impl fmt::Debug for BatchLinearizer {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("BatchLinearizer").finish_non_exhaustive()
    }
}

impl BatchLinearizer {
    /// Creates memory for a batch.
    ///
    /// # Errors
    /// Returns an error if the processor lacks the compiled instructions.
    pub fn new(batch: &Batch<f64>) -> Result<Self, SimError> {
        let threads = batch.threads().clamp(1, batch.count().max(1));
        let workers = (0..threads).map(|_| {
            let sim = Sim::with_options(batch.model().clone(), batch.options().options)?;
            let linearizer = Linearizer::new(sim.model())?;
            Ok(Worker { sim, linearizer })
        });
        Ok(BatchLinearizer {
            workers: workers.collect::<Result<_, SimError>>()?,
            results: vec![Linearization::default(); batch.count()],
        })
    }

    /// Linearizes the next step of every environment of the batch, whose state does not change.
    ///
    /// # Errors
    /// Returns the error of the first environment that has one, with its index.
    pub fn linearize(
        &mut self,
        batch: &mut Batch<f64>,
        request: &Request,
    ) -> Result<&[Linearization], (usize, SimError)> {
        let batch = &Mutex::new(batch);
        let share = self.results.len().div_ceil(self.workers.len()).max(1);
        let parts = self.workers.iter_mut().zip(self.results.chunks_mut(share));
        let first = std::thread::scope(|scope| {
            let run = |(part, (worker, results)): (usize, (&'_ mut Worker, &'_ mut [_]))| {
                worker.run(batch, request, part * share, results)
            };
            let mut parts = parts.enumerate();
            // This thread takes the first part.
            let own = parts.next();
            let others = Vec::from_iter(parts.map(|part| scope.spawn(move || run(part))));
            let own = own.map_or(Ok(()), run);
            let others = others.into_iter().map(|other| match other.join() {
                Ok(result) => result,
                Err(panic) => std::panic::resume_unwind(panic),
            });
            others.fold(own, Result::and)
        });
        first.map(|()| &self.results[..])
    }
}

impl Worker {
    /// Linearizes consecutive environments, from `first` on.
    fn run(
        &mut self,
        batch: &Mutex<&mut Batch<f64>>,
        request: &Request,
        first: usize,
        results: &mut [Linearization],
    ) -> Result<(), (usize, SimError)> {
        for (env, result) in (first..).zip(results) {
            let copied = match batch.lock() {
                Ok(batch) => batch.copy_to_sim(env, &mut self.sim),
                // Another thread panicked, which ends the call.
                Err(_) => return Ok(()),
            };
            let linearized = copied.and_then(|()| self.linearizer.linearize(&self.sim, request));
            result.clone_from(linearized.map_err(|error| (env, error))?);
        }
        Ok(())
    }
}
