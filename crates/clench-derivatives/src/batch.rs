//! The derivatives of every environment of a batch.

use crate::{
    InputGradient, InputTangent, Linearization, Linearizer, Matrix, OutputGradient, OutputTangent,
    Request, RolloutGradient,
};
use clench_rigid::batch::Precision;
use clench_rigid::{Batch, Model, Output, Sim, SimError};
use std::any::Any;
use std::fmt;
use std::sync::Mutex;

/// An error of an environment of a batch.
#[derive(Debug)]
pub struct EnvError {
    /// The index of the environment.
    pub env: usize,
    /// Its error.
    pub error: SimError,
}

impl fmt::Display for EnvError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "environment {}: {}", self.env, self.error)
    }
}

impl std::error::Error for EnvError {}

/// Computes the derivatives of a batch on as many threads as the batch has, and reuses its memory. Derivatives are
/// computed in double precision, also those of a batch in single precision.
pub struct BatchLinearizer<S: Precision = f64> {
    workers: Vec<Worker<S>>,
    results: Vec<Linearization>,
    along: Vec<OutputTangent>,
    gradients: Vec<InputGradient>,
    rollouts: Vec<RolloutGradient>,
}

/// The memory of a thread, which serves its environments in turn: for each model of the batch, once it is needed.
struct Worker<S: Precision> {
    own: Vec<Own<S>>,
}

/// The memory for a model.
struct Own<S: Precision> {
    /// The simulation of the environment; recreated in each call, because options may have changed.
    sim: Option<Sim<S>>,
    /// The same in double precision, for a batch in single precision.
    double: Option<Sim<f64>>,
    linearizer: Option<Linearizer>,
}

impl<S: Precision> Own<S> {
    const EMPTY: Self = Own {
        sim: None,
        double: None,
        linearizer: None,
    };
}

impl<S: Precision> fmt::Debug for BatchLinearizer<S> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("BatchLinearizer").finish_non_exhaustive()
    }
}

impl<S: Precision> BatchLinearizer<S> {
    /// Creates memory for a batch.
    pub fn new(batch: &Batch<S>) -> Self {
        let threads = batch.threads().clamp(1, batch.count().max(1));
        let workers = (0..threads).map(|_| Worker {
            own: batch.models().iter().map(|_| Own::EMPTY).collect(),
        });
        BatchLinearizer {
            workers: workers.collect(),
            results: vec![Linearization::default(); batch.count()],
            along: vec![OutputTangent::default(); batch.count()],
            gradients: vec![InputGradient::default(); batch.count()],
            rollouts: vec![RolloutGradient::default(); batch.count()],
        }
    }

    /// Linearizes the next step of every environment of the batch, whose state does not change.
    ///
    /// # Errors
    /// Returns the error of the first environment that has one. A batch of several models has no derivatives by
    /// parameters of geoms, and none of outputs whose number differs between models; nor are there any if the processor
    /// lacks the compiled instructions.
    ///
    /// # Panics
    /// Panics if the batch has another number of environments than the one that this was created for.
    pub fn linearize(
        &mut self,
        batch: &mut Batch<S>,
        request: &Request,
    ) -> Result<&[Linearization], EnvError> {
        check_alike(batch, request).map_err(|error| EnvError { env: 0, error })?;
        let results = &mut self.results;
        run(
            &mut self.workers,
            batch,
            results,
            |linearizer, sim, _, result| {
                linearizer.linearize(sim, request)?;
                std::mem::swap(result, &mut linearizer.result);
                Ok(())
            },
        )?;
        Ok(results)
    }

    /// Returns the directional derivatives of the next step of every environment, each along its own tangent; see
    /// [`Linearizer::jvp`].
    ///
    /// # Errors
    /// Returns the errors of [`linearize`](Self::linearize).
    ///
    /// # Panics
    /// Panics if the number of tangents is not that of environments, or if a matrix has another shape.
    pub fn jvp(
        &mut self,
        batch: &mut Batch<S>,
        request: &Request,
        tangents: &[InputTangent],
    ) -> Result<&[OutputTangent], EnvError> {
        check_alike(batch, request).map_err(|error| EnvError { env: 0, error })?;
        let results = &mut self.along;
        assert_eq!(tangents.len(), results.len(), "one tangent an environment");
        run(
            &mut self.workers,
            batch,
            results,
            |linearizer, sim, env, result| {
                linearizer.jvp(sim, request, &tangents[env])?;
                std::mem::swap(result, &mut linearizer.along);
                Ok(())
            },
        )?;
        Ok(results)
    }

    /// Returns the gradients of functions of the next step of every environment, each of its own functions; see
    /// [`Linearizer::vjp`].
    ///
    /// # Errors
    /// Returns the errors of [`linearize`](Self::linearize).
    ///
    /// # Panics
    /// Panics if the number of gradients is not that of environments, or if a matrix has another shape.
    pub fn vjp(
        &mut self,
        batch: &mut Batch<S>,
        request: &Request,
        gradients: &[OutputGradient],
    ) -> Result<&[InputGradient], EnvError> {
        check_alike(batch, request).map_err(|error| EnvError { env: 0, error })?;
        let results = &mut self.gradients;
        assert_eq!(
            gradients.len(),
            results.len(),
            "one gradient an environment"
        );
        run(
            &mut self.workers,
            batch,
            results,
            |linearizer, sim, env, result| {
                linearizer.vjp(sim, request, &gradients[env])?;
                std::mem::swap(result, &mut linearizer.gradient);
                Ok(())
            },
        )?;
        Ok(results)
    }
}

impl<S: Precision> BatchLinearizer<S> {
    /// Returns the gradients of functions of the states of rollouts, one from every environment with its own controls;
    /// see [`Linearizer::rollout_vjp`].
    ///
    /// # Errors
    /// Returns the error of the first environment that has one.
    ///
    /// # Panics
    /// Panics if the number of matrices is not that of environments, or if a matrix has another shape.
    pub fn rollout_vjp(
        &mut self,
        batch: &mut Batch<S>,
        memory: bool,
        controls: &[Matrix],
        gradients: &[Matrix],
    ) -> Result<&[RolloutGradient], EnvError> {
        self.rollout_vjp_while(batch, memory, controls, gradients, &|| true)
    }

    /// Returns these gradients while `go_on` returns true, see
    /// [`Linearizer::rollout_vjp_while`]. All threads call it.
    ///
    /// # Errors
    /// See [`rollout_vjp`](Self::rollout_vjp).
    ///
    /// # Panics
    /// See [`rollout_vjp`](Self::rollout_vjp).
    pub fn rollout_vjp_while(
        &mut self,
        batch: &mut Batch<S>,
        memory: bool,
        controls: &[Matrix],
        gradients: &[Matrix],
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<&[RolloutGradient], EnvError> {
        let results = &mut self.rollouts;
        let counts = [controls.len(), gradients.len()];
        assert_eq!(counts, [results.len(); 2], "one matrix an environment");
        run(
            &mut self.workers,
            batch,
            results,
            |linearizer, sim, env, result| {
                let (controls, gradient) = (&controls[env], &gradients[env]);
                linearizer.rollout_vjp_while(sim, memory, controls, gradient, go_on)?;
                std::mem::swap(result, &mut linearizer.rollout);
                Ok(())
            },
        )?;
        Ok(results)
    }
}

/// Calls a function for every environment, on the threads of the workers: with the memory for its derivatives, a copy
/// of it, its index and its result. Returns the error of the first that has one.
fn run<S: Precision, R: Send>(
    workers: &mut [Worker<S>],
    batch: &mut Batch<S>,
    results: &mut [R],
    each: impl Fn(&mut Linearizer, &Sim<f64>, usize, &mut R) -> Result<(), SimError> + Sync,
) -> Result<(), EnvError> {
    assert_eq!(batch.count(), results.len(), "the batch of this memory");
    let (batch, each) = (&Mutex::new(batch), &each);
    let share = results.len().div_ceil(workers.len()).max(1);
    let parts = workers.iter_mut().zip(results.chunks_mut(share));
    std::thread::scope(|scope| {
        let run = |(part, (worker, results)): (usize, (&'_ mut Worker<S>, &'_ mut [R]))| {
            worker.run(batch, part * share, results, each)
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
    })
}

impl<S: Precision> Worker<S> {
    /// Calls a function for consecutive environments, from `first` on.
    fn run<R>(
        &mut self,
        batch: &Mutex<&mut Batch<S>>,
        first: usize,
        results: &mut [R],
        each: &impl Fn(&mut Linearizer, &Sim<f64>, usize, &mut R) -> Result<(), SimError>,
    ) -> Result<(), EnvError> {
        for own in &mut self.own {
            own.sim = None;
        }
        for (env, result) in (first..).zip(results) {
            let copied = match batch.lock() {
                Ok(batch) => self.copy(&batch, env),
                // Another thread panicked, which ends the call.
                Err(_) => return Ok(()),
            };
            copied
                .and_then(|(sim, linearizer)| each(linearizer, sim, env, result))
                .map_err(|error| EnvError { env, error })?;
        }
        Ok(())
    }

    /// Copies an environment. Returns its simulation and the memory for its derivatives.
    fn copy(
        &mut self,
        batch: &Batch<S>,
        env: usize,
    ) -> Result<(&Sim<f64>, &mut Linearizer), SimError> {
        let Own {
            sim,
            double,
            linearizer,
        } = &mut self.own[batch.env_model(env)];
        let sim = match sim {
            Some(sim) => {
                batch.copy_to_sim(env, sim)?;
                sim
            }
            empty => empty.insert(batch.sim(env)?),
        };
        let sim = match (sim as &dyn Any).downcast_ref() {
            Some(sim) => sim,
            None => &*double.insert(sim.in_double_precision()?),
        };
        let linearizer = match linearizer {
            Some(linearizer) => linearizer,
            empty => empty.insert(Linearizer::new(sim.model())?),
        };
        Ok((sim, linearizer))
    }
}

/// Checks that the derivatives of environments of different models are matrices of one shape.
fn check_alike<S: Precision>(batch: &Batch<S>, request: &Request) -> Result<(), SimError> {
    let [first, others @ ..] = batch.models() else {
        return Ok(());
    };
    if others.is_empty() {
        return Ok(());
    }
    if (request.parameters.iter()).any(|(field, _)| field.is_of_geoms()) {
        return Err(SimError::OneModel("a derivative by a parameter of geoms"));
    }
    let differs = |output: &Output| {
        let width = |model: &Model| output.width(model);
        others.iter().any(|other| width(other) != width(first))
    };
    match request.outputs.iter().any(differs) {
        true => Err(SimError::OneModel("a derivative of an output of geoms")),
        false => Ok(()),
    }
}
