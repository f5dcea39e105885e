//! A viewer beside a loop that steps the simulation itself: the loop calls it between steps.

use crate::command::Command;
use crate::frame::Timing;
use crate::interaction::Interaction;
use crate::marks::Marks;
use crate::stages::StageClock;
use crate::viewed::Viewed;
use crate::{Page, Scene, ServeError, Server, ServerOptions};
use clench::SimError;
use std::time::{Duration, Instant};

/// Time between frames while a page looks.
const PERIOD: Duration = Duration::from_micros(16_667);
/// Time between frames while none does, so that one that comes finds something.
const IDLE_PERIOD: Duration = Duration::from_millis(500);
/// How long a loop that stands still waits before it looks again at what users do.
const REST: Duration = Duration::from_millis(10);
/// A loop that is later than this, s, is no longer waited for: it does not make up for it.
const LATE: f64 = 0.1;
/// A loop that is further ahead than this, s, has jumped to another time or was told another speed.
const MAX_AHEAD: f64 = 10.0;

/// A server, what its users do, and what is drawn for them.
pub struct PassiveViewer {
    server: Server,
    /// What users have chosen.
    pub interaction: Interaction,
    /// What is drawn beside the scene.
    pub marks: Marks,
    /// Turns of the loop that users have asked for while it stands still.
    steps: u32,
    /// Real and simulated time from which on both are compared.
    anchor: Option<(Instant, f64)>,
    published: Option<Instant>,
    /// When the loop went on, and its simulated time then.
    left: Option<(Instant, f64)>,
    timing: Timing,
    stages: StageClock,
    /// How many steps the loop has taken since `stages` last read the profile.
    unread_steps: u32,
}

impl PassiveViewer {
    /// A server for what is viewed, which shows its present state as is chosen at first.
    ///
    /// # Errors
    /// Where one cannot listen, and why.
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
            anchor: None,
            published: None,
            left: None,
            timing: Timing::default(),
            stages: StageClock::default(),
            unread_steps: 0,
        };
        viewed.run_clocks(true);
        viewer.show(viewed);
        Ok(viewer)
    }

    /// The server.
    pub fn server(&self) -> &Server {
        &self.server
    }

    /// Does what users did since the last call, and shows what is now if that is due. Then the loop may go on, or it should wait
    /// so long and call again: because users let it stand still, or because it is ahead of the time that they chose.
    ///
    /// # Errors
    /// A state that cannot be pulled at.
    pub fn sync<V: Viewed>(&mut self, viewed: &mut V) -> Result<Option<Duration>, SimError> {
        let env = self.interaction.selection.env;
        self.measure(viewed, env);
        for command in self.server.commands() {
            self.take(viewed, command);
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
            self.left = Some((Instant::now(), viewed.time(env)));
        }
        Ok(wait)
    }

    /// Leaves what is viewed as it would be without a viewer: nothing pulls at it, and no clock runs.
    ///
    /// # Errors
    /// An environment that is no longer there.
    pub fn leave<V: Viewed>(&mut self, viewed: &mut V) -> Result<(), SimError> {
        viewed.run_clocks(false);
        self.interaction.release(viewed)
    }

    /// Shows what is now.
    pub fn show<V: Viewed>(&mut self, viewed: &mut V) {
        self.published = Some(Instant::now());
        if self.unread_steps > 0 {
            let steps = std::mem::take(&mut self.unread_steps);
            self.timing.stages = self.stages.mean_since_last(&viewed.profile(), steps);
        }
        match (self.interaction).frame(viewed, self.timing, None, &mut self.marks) {
            Ok(frame) => self.server.publish(frame),
            Err(error) => self.server.tell(&format!("nothing to show: {error}")),
        }
    }

    fn take<V: Viewed>(&mut self, viewed: &mut V, command: Command) {
        let done = match command {
            Command::Step { count } => {
                let checked = command.check(viewed.model(), viewed.envs());
                checked.map(|()| {
                    self.interaction.paused = true;
                    self.steps += count;
                })
            }
            Command::Rewind { .. } | Command::Moment { .. } => {
                Err("only the program whose loop steps could go back".to_owned())
            }
            command => self.interaction.apply(viewed, command),
        };
        if let Err(why) = done {
            self.server.tell(&why);
        }
    }

    /// Measures how long the loop was away, and how far it came.
    fn measure<V: Viewed>(&mut self, viewed: &V, env: usize) {
        let Some((when, before)) = self.left.take() else {
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

    /// How long the loop should wait at a simulated time, if it should.
    fn wait(&mut self, time: f64) -> Option<Duration> {
        if self.interaction.paused {
            self.anchor = None;
            if self.steps == 0 {
                return Some(REST);
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
            return Some(Duration::from_secs_f64(ahead).min(REST));
        }
        if !(-LATE..MAX_AHEAD).contains(&ahead) || time < start {
            self.anchor = None;
        }
        None
    }
}
