//! Steps a simulation in real time and does what users do in the page.

use crate::command::{Command, cone};
use crate::drag::Drag;
use crate::frame::{PAUSED, Timing, encode};
use clench::{RigidOptions, Sim, SimError, State};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How far back one can go, s of simulated time.
const REMEMBERED: f64 = 10.0;
/// States that are remembered, at most.
const MOMENTS: usize = 1200;

/// A simulation that moves by itself.
pub struct Player {
    sim: Sim<f64>,
    paused: bool,
    /// Simulated over real time; 0 for as fast as can be.
    factor: f64,
    drag: Option<Drag>,
    /// Simulated time that is due, s.
    due: f64,
    past: VecDeque<State<f64>>,
    timing: Timing,
}

impl Player {
    /// A simulation that begins to move, or stands still at first.
    pub fn new(sim: Sim<f64>, paused: bool) -> Self {
        Player {
            sim,
            paused,
            factor: 1.0,
            drag: None,
            due: 0.0,
            past: VecDeque::new(),
            timing: Timing::default(),
        }
    }

    /// The simulation.
    pub fn sim(&self) -> &Sim<f64> {
        &self.sim
    }

    /// Whether it stands still.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// The bytes of a frame of what is now.
    ///
    /// # Errors
    /// A state that cannot be evaluated.
    pub fn frame(&mut self) -> Result<Vec<u8>, SimError> {
        let flags = if self.paused { PAUSED } else { 0 };
        encode(&mut self.sim, flags, self.timing, self.drag.as_ref())
    }

    /// Takes the steps that are due after so much real time, but stops after `budget`.
    ///
    /// # Errors
    /// A motion that diverges; the simulation then stands still at its last good state.
    pub fn advance(&mut self, passed: Duration, budget: Duration) -> Result<(), SimError> {
        if self.paused {
            return Ok(());
        }
        let start = Instant::now();
        let before = self.sim.state.time;
        let timestep = self.sim.params().timestep;
        let fast = self.factor == 0.0;
        self.due += self.factor * passed.as_secs_f64();
        let mut steps = 0;
        while (fast || self.due >= timestep) && start.elapsed() < budget {
            self.step()?;
            self.due -= timestep;
            steps += 1;
        }
        if steps > 0 {
            self.timing.step = start.elapsed() / steps;
        }
        // What could not be done in time is not made up for.
        self.due = self.due.clamp(0.0, timestep);
        self.timing.speed = (self.sim.state.time - before) / passed.as_secs_f64().max(1e-9);
        Ok(())
    }

    fn step(&mut self) -> Result<(), SimError> {
        self.remember();
        if let Some(drag) = &mut self.drag {
            drag.apply(&mut self.sim);
        }
        let done = self.sim.step();
        if done.is_err() {
            self.paused = true;
        }
        done
    }

    /// Keeps the state if enough time has passed since the last that was kept.
    fn remember(&mut self) {
        let time = self.sim.state.time;
        let due = |last: &State<f64>| time >= last.time + REMEMBERED / MOMENTS as f64;
        if self.past.back().is_none_or(due) {
            if self.past.len() == MOMENTS {
                self.past.pop_front();
            }
            self.past.push_back(self.sim.state.clone());
        }
    }

    /// Does what a user did, if the model has what it needs.
    ///
    /// # Errors
    /// Why it cannot be done; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), String> {
        command.check(self.sim.model())?;
        let said = |error: SimError| error.to_string();
        match command {
            Command::Pause { on } => self.paused = on,
            Command::Step { count } => {
                self.paused = true;
                (0..count).try_for_each(|_| self.step()).map_err(said)?;
            }
            Command::Reset {} => {
                self.forget();
                self.sim.reset();
            }
            Command::Keyframe { index } => {
                self.forget();
                self.sim.reset_to_keyframe(index).map_err(said)?;
            }
            Command::Speed { factor } => self.factor = factor,
            Command::Control { index, value } => self.sim.state.ctrl[index] = value,
            Command::Position { index, value } => {
                self.sim.state.qpos[index] = value;
                self.sim.state.qvel.fill(0.0);
                self.sim.forward().map_err(said)?;
            }
            Command::Equality { index, on } => {
                self.sim.set_equality_active(index, on).map_err(said)?;
                self.sim.forward().map_err(said)?;
            }
            Command::Drag {
                body,
                point,
                target,
            } => match &mut self.drag {
                Some(drag) if drag.body == body => drag.target = target,
                _ => {
                    self.release();
                    self.drag = Some(Drag::new(body, point, target));
                }
            },
            Command::Release {} => self.release(),
            Command::Options {
                elliptic,
                iterations,
                tolerance,
                noslip_iterations,
            } => {
                let mut options = self.sim.options();
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
                self.set_options(options).map_err(said)?;
            }
            Command::Rewind { seconds } => self.rewind(seconds),
        }
        Ok(())
    }

    /// Goes on with other options from the same state.
    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        let mut sim = Sim::with_options(Arc::clone(self.sim.model()), options)?;
        sim.state.copy_from(&self.sim.state);
        self.sim = sim;
        self.sim.forward()
    }

    fn release(&mut self) {
        if let Some(drag) = self.drag.take() {
            drag.release(&mut self.sim);
        }
    }

    /// Begins a new past.
    fn forget(&mut self) {
        self.release();
        self.past.clear();
        self.due = 0.0;
    }

    /// Back to the remembered state that is nearest to so long ago, standing still there.
    fn rewind(&mut self, seconds: f64) {
        self.paused = true;
        self.release();
        let wanted = self.sim.state.time - seconds;
        while self.past.len() > 1 && self.past.back().is_some_and(|last| last.time > wanted) {
            self.past.pop_back();
        }
        if let Some(state) = self.past.back() {
            self.sim.state.copy_from(state);
        }
    }
}
