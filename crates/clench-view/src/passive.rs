//! A viewer for a loop that steps the simulation itself: the loop calls it between steps.

use crate::command::Command;
use crate::frame::Timing;
use crate::interaction::Interaction;
use crate::marks::Marks;
use crate::stages::StageClock;
use crate::viewed::Viewed;
use crate::{Page, Scene, ServeError, Server, ServerOptions};
use clench::SimError;
use std::time::{Duration, Instant};

/// The interval between frames while a page is connected.
const PERIOD: Duration = Duration::from_micros(16_667);
/// The interval between frames while no page is connected, so that a new one finds a frame.
const IDLE_PERIOD: Duration = Duration::from_millis(500);
/// The interval between polls of the commands while the loop is paused.
const PAUSED_PERIOD: Duration = Duration::from_millis(10);
/// The maximum delay that the loop compensates, s.
const LATE: f64 = 0.1;
/// The lead of the loop, s, above which it is assumed to have jumped in time or to have a new speed.
const MAX_AHEAD: f64 = 10.0;

/// A server, the state of its users and their marks.
pub struct PassiveViewer {
    server: Server,
    /// The choices of the users.
    pub interaction: Interaction,
    /// The marks drawn in addition to the scene.
    pub marks: Marks,
    /// The loop iterations that users have requested while it is paused.
    steps: u32,
    /// True if the last call lets a paused loop take one of them.
    steps_now: bool,
    /// The real and simulated time from which both are compared.
    anchor: Option<(Instant, f64)>,
    published: Option<Instant>,
    /// The real and simulated time at which the loop resumed.
    resumed: Option<(Instant, f64)>,
    timing: Timing,
    stages: StageClock,
    /// The number of steps since `stages` last read the profile.
    unread_steps: u32,
}

impl PassiveViewer {
    /// Starts a server for a simulation and publishes its present state.
    ///
    /// # Errors
    /// Returns an error if the server cannot listen.
    pub fn start<V: Viewed>(
        options: &ServerOptions,
        page: Page,
        interaction: Interaction,
        viewed: &mut V,
    ) -> Result<Self, ServeError> {
        let scene = Scene::new(viewed.model())
            .of_envs(viewed.envs())
            .without_past();
        let mut viewer = PassiveViewer {
            server: Server::start(options, page, &scene)?,
            interaction,
            marks: Marks::default(),
            steps: 0,
            steps_now: false,
            anchor: None,
            published: None,
            resumed: None,
            timing: Timing::default(),
            stages: StageClock::default(),
            unread_steps: 0,
        };
        viewed.run_clocks(true);
        viewer.show(viewed);
        Ok(viewer)
    }

    /// Returns the server.
    pub fn server(&self) -> &Server {
        &self.server
    }

    /// Returns true if the loop should pause. It should not in an iteration that users have requested, until the next
    /// call of [`sync`](Self::sync).
    pub fn paused(&self) -> bool {
        self.interaction.paused && !self.steps_now
    }

    /// Pauses the loop, or lets it continue.
    pub fn set_paused(&mut self, paused: bool) {
        self.interaction.paused = paused;
        self.steps_now = false;
    }

    /// Executes the commands since the last call and publishes a frame if one is due. Returns `None` if the loop may
    /// continue; otherwise the time to wait before the next call, because users paused it or because it is ahead of the
    /// selected speed.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated for the spring.
    pub fn sync<V: Viewed>(&mut self, viewed: &mut V) -> Result<Option<Duration>, SimError> {
        let env = self.interaction.selection.env;
        self.measure(viewed, env);
        for command in self.server.commands() {
            self.execute(viewed, command);
        }
        self.interaction.pull(viewed)?;
        let due = match self.server.clients() {
            0 => IDLE_PERIOD,
            _ => PERIOD,
        };
        if self.published.is_none_or(|last| last.elapsed() >= due) {
            self.show(viewed);
        }
        let wait = self.wait(viewed.time(self.interaction.selection.env));
        if wait.is_none() {
            self.marks.shown();
            let env = self.interaction.selection.env;
            self.resumed = Some((Instant::now(), viewed.time(env)));
        }
        Ok(wait)
    }

    /// Removes the effect of the viewer: the spring is released and the clocks stop.
    ///
    /// # Errors
    /// Returns an error if the environment no longer exists.
    pub fn leave<V: Viewed>(&mut self, viewed: &mut V) -> Result<(), SimError> {
        viewed.run_clocks(false);
        self.interaction.release(viewed)
    }

    /// Publishes a frame of the present state.
    pub fn show<V: Viewed>(&mut self, viewed: &mut V) {
        self.published = Some(Instant::now());
        if self.unread_steps > 0 {
            let steps = std::mem::take(&mut self.unread_steps);
            self.timing.stages = self.stages.mean_since_last(&viewed.profile(), steps);
        }
        match (self.interaction).frame(viewed, self.timing, None, &mut self.marks) {
            Ok(frame) => self.server.publish(frame),
            Err(error) => self
                .server
                .notify(&format!("the state cannot be shown: {error}")),
        }
    }

    fn execute<V: Viewed>(&mut self, viewed: &mut V, command: Command) {
        let done = match command {
            Command::Step { count } => {
                let checked = command.check(viewed.model(), viewed.envs());
                checked.map(|()| {
                    self.interaction.paused = true;
                    self.steps += count;
                })
            }
            Command::Rewind { .. } | Command::Moment { .. } => {
                Err("the viewer cannot go back: another program steps this simulation".to_owned())
            }
            command => self.interaction.apply(viewed, command),
        };
        if let Err(why) = done {
            self.server.notify(&why);
        }
    }

    /// Measures the duration and the number of steps since the loop resumed.
    fn measure<V: Viewed>(&mut self, viewed: &V, env: usize) {
        let Some((when, before)) = self.resumed.take() else {
            return;
        };
        let time = viewed.time(env);
        let steps = ((time - before) / viewed.model().params.timestep)
            .round()
            .max(1.0);
        self.timing.step = when.elapsed().div_f64(steps);
        self.unread_steps = self.unread_steps.saturating_add(steps as u32);
        if let Some((when, before)) = self.anchor {
            self.timing.speed = (time - before) / when.elapsed().as_secs_f64().max(1e-9);
        }
    }

    /// Returns the time that the loop should wait at a simulated time, if any.
    fn wait(&mut self, time: f64) -> Option<Duration> {
        self.steps_now = self.interaction.paused && self.steps > 0;
        if self.interaction.paused {
            self.anchor = None;
            if self.steps == 0 {
                return Some(PAUSED_PERIOD);
            }
            self.steps -= 1;
            return None;
        }
        self.steps = 0;
        let factor = self.interaction.factor;
        let &mut (when, start) = self.anchor.get_or_insert((Instant::now(), time));
        if factor == 0.0 {
            return None;
        }
        let ahead = (time - start) / factor - when.elapsed().as_secs_f64();
        if ahead > 0.0 && time >= start && ahead < MAX_AHEAD {
            return Some(Duration::from_secs_f64(ahead).min(PAUSED_PERIOD));
        }
        if !(-LATE..MAX_AHEAD).contains(&ahead) || time < start {
            self.anchor = None;
        }
        None
    }
}
