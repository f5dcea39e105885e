//! Where the time goes: a stopwatch that is compiled in and costs a branch a lap while it does not run.

use std::time::{Duration, Instant};

/// Time spent in each of `N` parts.
#[derive(Clone, Debug)]
pub struct Stopwatch<const N: usize> {
    /// The last lap's end, if it runs.
    since: Option<Instant>,
    running: bool,
    spent: [Duration; N],
}

impl<const N: usize> Default for Stopwatch<N> {
    fn default() -> Self {
        Stopwatch {
            since: None,
            running: false,
            spent: [Duration::ZERO; N],
        }
    }
}

impl<const N: usize> Stopwatch<N> {
    /// Lets it run, or not; the times spent so far stay.
    pub fn run(&mut self, running: bool) {
        self.running = running;
        self.since = None;
    }

    /// Whether it runs.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Begins a first lap.
    #[inline(always)]
    pub fn start(&mut self) {
        if self.running {
            self.since = Some(Instant::now());
        }
    }

    /// Ends a lap, whose time goes to `part`, and begins the next.
    #[inline(always)]
    pub fn lap(&mut self, part: usize) {
        if self.running {
            self.end_lap(part);
        }
    }

    #[cold]
    fn end_lap(&mut self, part: usize) {
        let now = Instant::now();
        if let Some(since) = self.since.replace(now) {
            self.spent[part] += now - since;
        }
    }

    /// Runs if another does.
    pub fn run_as(&mut self, other: &Self) {
        if self.running != other.running {
            self.run(other.running);
        }
    }

    /// Takes the time that another has measured.
    pub fn absorb(&mut self, other: &mut Self) {
        for (spent, other) in self.spent.iter_mut().zip(&mut other.spent) {
            *spent += std::mem::take(other);
        }
    }

    /// The time spent in each part.
    pub fn spent(&self) -> &[Duration; N] {
        &self.spent
    }
}

/// What a solve spends its time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolvePart {
    /// The better of two starting points, and whether it is good enough already.
    Start,
    /// H.
    Hessian,
    /// Its factorization, or an update of it.
    Factorization,
    /// The direction.
    Direction,
    /// How far to go along it.
    LineSearch,
    /// Costs and gradient at the new point, and whether to stop there.
    Evaluation,
}

impl SolvePart {
    /// How many there are.
    pub const COUNT: usize = 6;
}

/// Times the parts of solves.
pub type SolveClock = Stopwatch<{ SolvePart::COUNT }>;
