//! The objects that can be viewed: a simulation, or the environments of a batch as one simulation each.

use clench::rigid::profile::Profile;
use clench::rigid::{Precision, Sim};
use clench::{Batch, EnvStatus, Model, RigidOptions, SimError, State};
use std::sync::Arc;

/// A simulation or batch that can be viewed and modified.
pub trait Viewed {
    /// The scalar type.
    type Scalar: Precision;

    /// Returns the model.
    fn model(&self) -> &Arc<Model>;

    /// Returns the model of an environment, if they have different models.
    fn model_of(&self, env: usize) -> &Arc<Model> {
        let _ = env;
        self.model()
    }

    /// Returns the number of environments.
    fn envs(&self) -> usize;

    /// Returns the simulated time of an environment, s.
    fn time(&self, env: usize) -> f64;

    /// Calls a function with the simulation of an environment.
    ///
    /// # Errors
    /// Returns an error if the environment does not exist.
    fn query<R>(
        &mut self,
        env: usize,
        query: impl FnOnce(&mut Sim<Self::Scalar>) -> R,
    ) -> Result<R, SimError>;

    /// Calls a function with each of some environments in order.
    ///
    /// # Errors
    /// See [`query`](Self::query).
    fn query_each(
        &mut self,
        envs: impl IntoIterator<Item = usize>,
        mut query: impl FnMut(usize, &mut Sim<Self::Scalar>),
    ) -> Result<(), SimError> {
        envs.into_iter()
            .try_for_each(|env| self.query(env, |sim| query(env, sim)))
    }

    /// Changes the state of an environment.
    ///
    /// # Errors
    /// Returns an error if the environment does not exist or the change fails; the state has not changed then.
    fn change(
        &mut self,
        env: usize,
        change: impl FnOnce(&mut Sim<Self::Scalar>) -> Result<(), SimError>,
    ) -> Result<(), SimError>;

    /// Resets an environment to the initial state or to a keyframe.
    ///
    /// # Errors
    /// Returns an error if the environment or keyframe does not exist.
    fn reset(&mut self, env: usize, keyframe: Option<usize>) -> Result<(), SimError>;

    /// Returns the options.
    fn options(&self) -> RigidOptions;

    /// Sets the options of all environments.
    ///
    /// # Errors
    /// Returns an error if an option is out of range.
    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError>;

    /// Returns the reason if an environment cannot continue.
    fn fault(&self, env: usize) -> Option<String>;

    /// Starts or stops the clocks of a step's stages.
    fn run_clocks(&mut self, running: bool);

    /// Returns the time of the stages while the clocks ran.
    fn profile(&mut self) -> Profile;
}

/// A simulation or batch that the viewer can step.
pub trait Stepped: Viewed {
    /// Takes a step.
    ///
    /// # Errors
    /// Returns an error if the motion diverges; nothing has changed then.
    fn step(&mut self) -> Result<(), SimError>;

    /// Returns a copy of the state to rewind to, if supported.
    fn moment(&self) -> Option<State<Self::Scalar>>;

    /// Restores a state.
    fn go_back(&mut self, moment: &State<Self::Scalar>);
}

impl<S: Precision> Viewed for Sim<S> {
    type Scalar = S;

    fn model(&self) -> &Arc<Model> {
        self.model()
    }

    fn envs(&self) -> usize {
        1
    }

    fn time(&self, _: usize) -> f64 {
        self.state.time
    }

    fn query<R>(&mut self, _: usize, query: impl FnOnce(&mut Sim<S>) -> R) -> Result<R, SimError> {
        Ok(query(self))
    }

    fn change(
        &mut self,
        _: usize,
        change: impl FnOnce(&mut Sim<S>) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        let before = self.state.clone();
        change(self).inspect_err(|_| self.state.copy_from(&before))
    }

    fn reset(&mut self, _: usize, keyframe: Option<usize>) -> Result<(), SimError> {
        match keyframe {
            None => self.reset(),
            Some(index) => self.reset_to_keyframe(index)?,
        }
        Ok(())
    }

    fn options(&self) -> RigidOptions {
        self.options()
    }

    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        self.set_options(options)
    }

    fn fault(&self, _: usize) -> Option<String> {
        None
    }

    fn run_clocks(&mut self, running: bool) {
        self.run_clocks(running);
    }

    fn profile(&mut self) -> Profile {
        self.profile()
    }
}

impl<S: Precision> Stepped for Sim<S> {
    fn step(&mut self) -> Result<(), SimError> {
        self.step()
    }

    fn moment(&self) -> Option<State<S>> {
        Some(self.state.clone())
    }

    fn go_back(&mut self, moment: &State<S>) {
        self.state.copy_from(moment);
    }
}

impl<S: Precision> Viewed for Batch<S> {
    type Scalar = S;

    fn model(&self) -> &Arc<Model> {
        self.model()
    }

    fn model_of(&self, env: usize) -> &Arc<Model> {
        &self.models()[self.env_model(env)]
    }

    fn envs(&self) -> usize {
        self.count()
    }

    fn time(&self, env: usize) -> f64 {
        self.state.time.row(env)[0]
    }

    fn query<R>(
        &mut self,
        env: usize,
        query: impl FnOnce(&mut Sim<S>) -> R,
    ) -> Result<R, SimError> {
        Ok(query(&mut self.sim(env)?))
    }

    fn query_each(
        &mut self,
        envs: impl IntoIterator<Item = usize>,
        mut query: impl FnMut(usize, &mut Sim<S>),
    ) -> Result<(), SimError> {
        let mut envs = envs.into_iter();
        let Some(first) = envs.next() else {
            return Ok(());
        };
        // One simulation is reused for all environments.
        let mut sim = self.sim(first)?;
        query(first, &mut sim);
        envs.try_for_each(|env| {
            self.copy_to_sim(env, &mut sim)?;
            query(env, &mut sim);
            Ok(())
        })
    }

    fn change(
        &mut self,
        env: usize,
        change: impl FnOnce(&mut Sim<S>) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        let mut sim = self.sim(env)?;
        change(&mut sim)?;
        self.state.write(env, &sim.state)
    }

    fn reset(&mut self, env: usize, keyframe: Option<usize>) -> Result<(), SimError> {
        match keyframe {
            None => self.reset(env),
            Some(index) => self.reset_to_keyframe(env, index),
        }
    }

    fn options(&self) -> RigidOptions {
        self.options().options
    }

    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        self.set_options(options)
    }

    fn fault(&self, env: usize) -> Option<String> {
        match self.status(env) {
            EnvStatus::Running => None,
            EnvStatus::Failed(fault) => Some(fault.to_string()),
        }
    }

    fn run_clocks(&mut self, running: bool) {
        self.run_clocks(running);
    }

    fn profile(&mut self) -> Profile {
        self.profile()
    }
}

impl<S: Precision> Stepped for Batch<S> {
    fn step(&mut self) -> Result<(), SimError> {
        self.step().map(drop)
    }

    /// Returns `None`: ten seconds of a thousand environments would exceed the memory.
    fn moment(&self) -> Option<State<S>> {
        None
    }

    fn go_back(&mut self, _: &State<S>) {}
}
