//! The choices of the page's users and their effect on a simulation, independent of the code that steps it.

use crate::command::{Command, cone};
use crate::drag::{Drag, Turn};
use crate::frame::{FrameExtras, PAUSED, Timing, encode};
use crate::marks::Marks;
use crate::viewed::Viewed;
use clench::math::Real;
use clench::rigid::{Precision, Sim};
use clench::{RigidOptions, SimError};

/// The selected environments of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// The environment that is plotted and interacted with.
    pub env: usize,
    /// The first environment of those side by side.
    pub first: usize,
    /// The number of environments side by side; 1 for `env` only.
    pub count: usize,
}

/// The choices of the page's users.
pub struct Interaction {
    /// True if the simulation is paused.
    pub paused: bool,
    /// The ratio of simulated to real time; 0 for as fast as possible.
    pub factor: f64,
    /// The selected environments.
    pub selection: Selection,
    /// The keyframe of the run's start, to which resets return; None for the initial state of the model.
    pub start: Option<usize>,
    /// The active spring and its environment.
    drag: Option<(usize, Perturbation)>,
}

/// A spring on a body.
enum Perturbation {
    /// Pulls the body.
    Pull(Drag),
    /// Rotates the body.
    Turn(Turn),
}

impl Perturbation {
    fn apply<T: Precision>(&mut self, sim: &mut Sim<T>) {
        match self {
            Perturbation::Pull(drag) => drag.apply(sim),
            Perturbation::Turn(turn) => turn.apply(sim),
        }
    }

    fn release<T: Precision>(&self, sim: &mut Sim<T>) {
        match self {
            Perturbation::Pull(drag) => drag.release(sim),
            Perturbation::Turn(turn) => turn.release(sim),
        }
    }
}

impl Interaction {
    /// Creates the state before any command.
    pub fn new(paused: bool) -> Self {
        Interaction {
            paused,
            factor: 1.0,
            selection: Selection {
                env: 0,
                first: 0,
                count: 1,
            },
            start: None,
            drag: None,
        }
    }

    /// Applies the present force of the spring, if there is one. Call it before each step.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated.
    pub fn pull<V: Viewed>(&mut self, viewed: &mut V) -> Result<(), SimError> {
        match &mut self.drag {
            None => Ok(()),
            Some((env, drag)) => viewed.change(*env, |sim| {
                sim.refresh()?;
                drag.apply(sim);
                Ok(())
            }),
        }
    }

    /// Releases the body.
    ///
    /// # Errors
    /// Returns an error if the environment no longer exists.
    pub fn release<V: Viewed>(&mut self, viewed: &mut V) -> Result<(), SimError> {
        match self.drag.take() {
            None => Ok(()),
            Some((env, drag)) => viewed.change(env, |sim| {
                drag.release(sim);
                Ok(())
            }),
        }
    }

    /// Executes a command. The caller handles steps and rewinding.
    ///
    /// # Errors
    /// Returns the reason if the command fails; nothing has changed then.
    pub fn apply<V: Viewed>(&mut self, viewed: &mut V, command: Command) -> Result<(), String> {
        command.check(viewed.model(), viewed.envs())?;
        self.execute(viewed, command)
            .map_err(|error| error.to_string())
    }

    fn execute<V: Viewed>(&mut self, viewed: &mut V, command: Command) -> Result<(), SimError> {
        let env = self.selection.env;
        match command {
            Command::Pause { on } => self.paused = on,
            Command::Speed { factor } => self.factor = factor,
            Command::Show { env, first, count } => {
                self.release(viewed)?;
                self.selection = Selection { env, first, count };
            }
            Command::Reset {} => {
                self.release(viewed)?;
                viewed.reset(env, self.start)?;
            }
            Command::Keyframe { index } => {
                self.release(viewed)?;
                viewed.reset(env, Some(index))?;
            }
            Command::Control { index, value } => viewed.change(env, |sim| {
                sim.state.ctrl[index] = V::Scalar::new(value);
                Ok(())
            })?,
            Command::Position { index, value } => viewed.change(env, |sim| {
                sim.state.qpos[index] = V::Scalar::new(value);
                sim.state.qvel.fill(V::Scalar::new(0.0));
                sim.forward()
            })?,
            Command::Equality { index, on } => viewed.change(env, |sim| {
                sim.set_equality_active(index, on)?;
                sim.forward()
            })?,
            Command::Drag {
                body,
                point,
                target,
            } => match &mut self.drag {
                Some((_, Perturbation::Pull(drag))) if drag.body == body => drag.target = target,
                _ => {
                    self.release(viewed)?;
                    self.drag = Some((env, Perturbation::Pull(Drag::new(body, point, target))));
                }
            },
            Command::Turn { body, target } => match &mut self.drag {
                Some((_, Perturbation::Turn(turn))) if turn.body == body => turn.target = target,
                _ => {
                    self.release(viewed)?;
                    self.drag = Some((env, Perturbation::Turn(Turn::new(body, target))));
                }
            },
            Command::Release {} => self.release(viewed)?,
            Command::Options {
                elliptic,
                iterations,
                tolerance,
                noslip_iterations,
            } => {
                let mut options: RigidOptions = viewed.options();
                if let Some(elliptic) = elliptic {
                    options = options.friction_cone(cone(elliptic));
                }
                if let Some(iterations) = iterations {
                    options = options.iterations(iterations);
                }
                if let Some(tolerance) = tolerance {
                    options = options.tolerance(tolerance);
                }
                if let Some(sweeps) = noslip_iterations {
                    options = options.noslip_iterations(sweeps);
                }
                viewed.set_options(options)?;
            }
            Command::Step { .. } | Command::Rewind { .. } | Command::Moment { .. } => {}
        }
        Ok(())
    }

    /// Encodes a frame of the present state; `past` are the first and last time that rewinding can reach, s.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated.
    pub fn frame<V: Viewed>(
        &self,
        viewed: &mut V,
        timing: Timing,
        past: Option<[f64; 2]>,
        marks: &mut Marks,
    ) -> Result<Vec<u8>, SimError> {
        let Selection { env, first, count } = self.selection;
        let (drag, turn) = match &self.drag {
            Some((_, Perturbation::Pull(drag))) => (Some(drag), None),
            Some((_, Perturbation::Turn(turn))) => (None, Some(turn)),
            None => (None, None),
        };
        let mut extras = FrameExtras {
            flags: if self.paused { PAUSED } else { 0 },
            timing,
            drag,
            turn,
            past,
            marks: marks.at(viewed.time(env)).collect(),
            ..FrameExtras::default()
        };
        if viewed.envs() > 1 {
            let seen = match count {
                1 => env..env + 1,
                count => first..(first + count).min(viewed.envs()),
            };
            extras.chosen = Some([env, first]);
            extras.envs = seen.clone().map(|env| (env, viewed.fault(env))).collect();
            if count > 1 {
                viewed.query_each(seen, |_, sim| extras.add_poses(sim))?;
            }
        }
        viewed.query(env, |sim| encode(sim, &extras))?
    }
}
