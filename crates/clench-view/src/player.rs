//! Steps a simulation in real time and does what users do in the page.

use crate::command::Command;
use crate::frame::Timing;
use crate::interaction::Interaction;
use crate::marks::Marks;
use crate::stages::StageClock;
use crate::viewed::Stepped;
use clench::{SimError, State};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// How far back one can go, s of simulated time.
const REMEMBERED: f64 = 10.0;
/// States that are remembered, at most.
const MOMENTS: usize = 1200;

/// A simulation, or a batch, that moves by itself.
pub struct Player<V: Stepped> {
    viewed: V,
    interaction: Interaction,
    /// Simulated time that is due, s.
    due: f64,
    past: VecDeque<State<V::Scalar>>,
    /// The remembered moment that is looked at: those after it are forgotten with the next step.
    at: Option<usize>,
    timing: Timing,
    stages: StageClock,
}

impl<V: Stepped> Player<V> {
    /// A simulation that begins to move, or stands still at first.
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

    /// The simulation.
    pub fn viewed(&self) -> &V {
        &self.viewed
    }

    /// What users have chosen.
    pub fn interaction(&mut self) -> &mut Interaction {
        &mut self.interaction
    }

    /// The bytes of a frame of what is now.
    ///
    /// # Errors
    /// A state that cannot be evaluated.
    pub fn frame(&mut self) -> Result<Vec<u8>, SimError> {
        let nothing = &mut Marks::default();
        let ends = self.past.front().zip(self.past.back());
        let now = self.time();
        let past = ends.map(|(first, last)| [first.time, last.time.max(now)]);
        (self.interaction).frame(&mut self.viewed, self.timing, past, nothing)
    }

    /// The simulated time of the environment that is looked at, s.
    fn time(&self) -> f64 {
        self.viewed.time(self.interaction.selection.env)
    }

    /// Takes the steps that are due after so much real time, but stops after `budget`.
    ///
    /// # Errors
    /// A motion that diverges; the simulation then stands still at its last good state.
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
        // What could not be done in time is not made up for.
        self.due = self.due.clamp(0.0, timestep);
        self.timing.speed = (self.time() - before) / passed.as_secs_f64().max(1e-9);
        Ok(())
    }

    fn step(&mut self) -> Result<(), SimError> {
        if let Some(at) = self.at.take() {
            self.past.truncate(at + 1);
        }
        self.remember();
        let pulled = self.interaction.pull(&mut self.viewed);
        let done = pulled.and_then(|()| self.viewed.step());
        if done.is_err() {
            self.interaction.paused = true;
        }
        done
    }

    /// Keeps the state if enough time has passed since the last that was kept.
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

    /// Does what a user did, if the model has what it needs.
    ///
    /// # Errors
    /// Why it cannot be done; nothing has changed then.
    pub fn apply(&mut self, command: Command) -> Result<(), String> {
        command.check(self.viewed.model(), self.viewed.envs())?;
        let said = |error: SimError| error.to_string();
        match command {
            Command::Step { count } => {
                self.interaction.paused = true;
                (0..count).try_for_each(|_| self.step()).map_err(said)
            }
            Command::Rewind { seconds } => self.go_to(self.time() - seconds).map_err(said),
            Command::Moment { time } => self.go_to(time).map_err(said),
            Command::Reset {} | Command::Keyframe { .. } => {
                self.past.clear();
                self.at = None;
                self.due = 0.0;
                self.interaction.apply(&mut self.viewed, command)
            }
            _ => self.interaction.apply(&mut self.viewed, command),
        }
    }

    /// To the last remembered state that is not after a time, s, standing still there. The present is remembered too, so that one can
    /// come forward again.
    fn go_to(&mut self, time: f64) -> Result<(), SimError> {
        self.interaction.paused = true;
        self.interaction.release(&mut self.viewed)?;
        if self.at.is_none() {
            let now = self.time();
            // What was changed by hand since it was remembered.
            if self.past.back().is_some_and(|last| last.time >= now) {
                self.past.pop_back();
            }
            self.past.extend(self.viewed.moment());
        }
        // Pages tell times in single precision.
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
