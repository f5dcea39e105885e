//! What can be looked at: a simulation, or the environments of a batch, each as a simulation of its own.

use clench::rigid::profile::Profile;
use clench::rigid::{Precision, Sim};
use clench::{Batch, EnvStatus, Model, RigidOptions, SimError, State};
use std::ops::Range;
use std::sync::Arc;

/// What can be looked at and touched.
pub trait Viewed {
    /// Its numbers.
    type Scalar: Precision;

    /// Its model.
    fn model(&self) -> &Arc<Model>;

    /// How many environments there are.
    fn envs(&self) -> usize;

    /// The simulated time of an environment, s.
    fn time(&self, env: usize) -> f64;

    /// Asks about an environment.
    ///
    /// # Errors
    /// An environment that is not there.
    fn ask<R>(
        &mut self,
        env: usize,
        ask: impl FnOnce(&mut Sim<Self::Scalar>) -> R,
    ) -> Result<R, SimError>;

    /// Asks about environments one after the other.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    fn ask_each(
        &mut self,
        envs: Range<usize>,
        mut ask: impl FnMut(usize, &mut Sim<Self::Scalar>),
    ) -> Result<(), SimError> {
        envs.into_iter()
            .try_for_each(|env| self.ask(env, |sim| ask(env, sim)))
    }

    /// Changes the state of an environment.
    ///
    /// # Errors
    /// An environment that is not there; why it cannot be changed.
    fn change(
        &mut self,
        env: usize,
        change: impl FnOnce(&mut Sim<Self::Scalar>) -> Result<(), SimError>,
    ) -> Result<(), SimError>;

    /// Lets an environment begin anew, or at a keyframe.
    ///
    /// # Errors
    /// An environment or keyframe that is not there.
    fn reset(&mut self, env: usize, keyframe: Option<usize>) -> Result<(), SimError>;

    /// The options.
    fn options(&self) -> RigidOptions;

    /// Sets the options of all environments.
    ///
    /// # Errors
    /// Options out of range.
    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError>;

    /// Why an environment cannot go on, if it cannot.
    fn fault(&self, env: usize) -> Option<String>;

    /// Lets the clocks of a step's stages run, or not.
    fn run_clocks(&mut self, running: bool);

    /// Where the time of steps went while the clocks ran.
    fn profile(&mut self) -> Profile;
}

/// What the viewer itself can step.
pub trait Stepped: Viewed {
    /// Takes a step.
    ///
    /// # Errors
    /// A motion that diverges; nothing has changed then.
    fn step(&mut self) -> Result<(), SimError>;

    /// What one can come back to, where that is kept.
    fn moment(&self) -> Option<State<Self::Scalar>>;

    /// Back to a moment.
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

    fn ask<R>(&mut self, _: usize, ask: impl FnOnce(&mut Sim<S>) -> R) -> Result<R, SimError> {
        Ok(ask(self))
    }

    fn change(
        &mut self,
        _: usize,
        change: impl FnOnce(&mut Sim<S>) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        change(self)
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

    fn envs(&self) -> usize {
        self.count()
    }

    fn time(&self, env: usize) -> f64 {
        self.state.time.row(env)[0]
    }

    fn ask<R>(&mut self, env: usize, ask: impl FnOnce(&mut Sim<S>) -> R) -> Result<R, SimError> {
        Ok(ask(&mut self.sim(env)?))
    }

    fn ask_each(
        &mut self,
        envs: Range<usize>,
        mut ask: impl FnMut(usize, &mut Sim<S>),
    ) -> Result<(), SimError> {
        let Some(first) = envs.clone().next() else {
            return Ok(());
        };
        // One simulation stands for all in turn.
        let mut sim = self.sim(first)?;
        envs.into_iter().try_for_each(|env| {
            self.copy_to_sim(env, &mut sim)?;
            ask(env, &mut sim);
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

    /// A thousand environments, ten seconds of them, would fill the memory.
    fn moment(&self) -> Option<State<S>> {
        None
    }

    fn go_back(&mut self, _: &State<S>) {}
}
