//! Steps a simulation in real time and executes the commands of users.

use crate::command::Command;
use crate::frame::Timing;
use crate::interaction::Interaction;
use crate::marks::Marks;
use crate::stages::StageClock;
use crate::viewed::Stepped;
use clench::{SimError, State};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// The rewind interval, s of simulated time.
const REMEMBERED: f64 = 10.0;
/// The maximum number of stored states.
const MOMENTS: usize = 1200;

/// A simulation or a batch that is stepped in real time.
pub struct Player<V: Stepped> {
    viewed: V,
    interaction: Interaction,
    /// The simulated time that is due, s.
    due: f64,
    past: VecDeque<State<V::Scalar>>,
    /// The index of the stored state that is shown; the next step discards those after it.
    at: Option<usize>,
    timing: Timing,
    stages: StageClock,
}

impl<V: Stepped> Player<V> {
    /// Creates a player that runs, or is paused at first.
    pub fn new(mut viewed: V, paused: bool) -> Self {
        viewed.run_clocks(true);
        Player {
            viewed,
            interaction: Interaction::new(paused),
            due: 0.0,
            past: VecDeque::new(),
            at: None,
            timing: Timing::default(),
            stages: StageClock::default(),
        }
    }

    /// Returns the simulation.
    pub fn viewed(&self) -> &V {
        &self.viewed
    }

    /// Returns the choices of the users.
    pub fn interaction(&mut self) -> &mut Interaction {
        &mut self.interaction
    }

    /// Encodes a frame of the present state.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated.
    pub fn frame(&mut self) -> Result<Vec<u8>, SimError> {
        let no_marks = &mut Marks::default();
        let ends = self.past.front().zip(self.past.back());
        let now = self.time();
        let past = ends.map(|(first, last)| [first.time, last.time.max(now)]);
        (self.interaction).frame(&mut self.viewed, self.timing, past, no_marks)
    }

    /// Returns the simulated time of the selected environment, s.
    fn time(&self) -> f64 {
        self.viewed.time(self.interaction.selection.env)
    }

    /// Takes the steps that are due after `passed` real time, but stops after `budget`.
    ///
    /// # Errors
    /// Returns an error if the motion diverges; the simulation then pauses at its last good state.
    pub fn advance(&mut self, passed: Duration, budget: Duration) -> Result<(), SimError> {
        if self.interaction.paused {
            return Ok(());
        }
        let start = Instant::now();
        let before = self.time();
        let timestep = self.viewed.model().params.timestep;
        let fast = self.interaction.factor == 0.0;
        self.due += self.interaction.factor * passed.as_secs_f64();
        let mut steps = 0;
        while (fast || self.due >= timestep) && start.elapsed() < budget {
            self.step()?;
            self.due -= timestep;
            steps += 1;
        }
        if steps > 0 {
            self.timing.step = start.elapsed() / steps;
            self.timing.stages = self.stages.mean_since_last(&self.viewed.profile(), steps);
        }
        // Steps that exceed the budget are dropped.
        self.due = self.due.clamp(0.0, timestep);
        self.timing.speed = (self.time() - before) / passed.as_secs_f64().max(1e-9);
        Ok(())
    }

    fn step(&mut self) -> Result<(), SimError> {
        if let Some(at) = self.at.take() {
            self.past.truncate(at + 1);
        }
        self.remember();
        let before = self.time();
        let pulled = self.interaction.pull(&mut self.viewed);
        let done = pulled.and_then(|()| self.viewed.step());
        if done.is_err() {
            self.interaction.paused = true;
        }
        // A motion that diverged may have been reset. The moments before belong to another motion, at the same times.
        if self.time() < before {
            self.past.clear();
        }
        done
    }

    /// Stores the state if enough time has passed since the last stored one.
    fn remember(&mut self) {
        let time = self.time();
        let due = |last: &State<V::Scalar>| time >= last.time + REMEMBERED / MOMENTS as f64;
        if self.past.back().is_none_or(due) {
            if self.past.len() == MOMENTS {
                self.past.pop_front();
            }
            self.past.extend(self.viewed.moment());
        }
    }

    /// Executes a command.
    ///
    /// # Errors
    /// Returns the reason if the command fails; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), String> {
        command.check(self.viewed.model(), self.viewed.envs())?;
        let to_text = |error: SimError| error.to_string();
        match command {
            Command::Step { count } => {
                self.interaction.paused = true;
                (0..count).try_for_each(|_| self.step()).map_err(to_text)
            }
            Command::Rewind { seconds } => self.go_to(self.time() - seconds).map_err(to_text),
            Command::Moment { time } => self.go_to(time).map_err(to_text),
            Command::Reset {} | Command::Keyframe { .. } => {
                self.past.clear();
                self.at = None;
                self.due = 0.0;
                self.interaction.apply(&mut self.viewed, command)
            }
            _ => self.interaction.apply(&mut self.viewed, command),
        }
    }

    /// Goes to the last stored state that is not after a time, s, and pauses. Stores the present state too, so that
    /// later moments stay available.
    fn go_to(&mut self, time: f64) -> Result<(), SimError> {
        self.interaction.paused = true;
        self.interaction.release(&mut self.viewed)?;
        if self.at.is_none() {
            let now = self.time();
            // The user may have changed the state since it was stored.
            if self.past.back().is_some_and(|last| last.time >= now) {
                self.past.pop_back();
            }
            self.past.extend(self.viewed.moment());
        }
        // Pages store times in single precision.
        let until = time + 0.5 * self.viewed.model().params.timestep;
        let at = self.past.iter().rposition(|moment| moment.time <= until);
        let at = at.unwrap_or(0);
        if let Some(state) = self.past.get(at) {
            self.viewed.go_back(state);
            self.at = Some(at);
        }
        Ok(())
    }
}
