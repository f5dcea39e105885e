//! A stopwatch for the parts of a computation; while stopped it costs one branch per lap.

use std::time::{Duration, Instant};

/// The time spent in each of `N` parts.
#[derive(Clone, Debug)]
pub struct Stopwatch<const N: usize> {
    /// The end of the last lap, if running.
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
    /// Starts or stops the stopwatch; the accumulated times stay.
    pub fn run(&mut self, running: bool) {
        self.running = running;
        self.since = None;
    }

    /// Returns true if the stopwatch runs.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Begins the first lap.
    #[inline(always)]
    pub fn start(&mut self) {
        if self.running {
            self.since = Some(Instant::now());
        }
    }

    /// Ends a lap, adds its time to `part`, and begins the next.
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

    /// Starts or stops the stopwatch like `other`.
    pub fn run_as(&mut self, other: &Self) {
        if self.running != other.running {
            self.run(other.running);
        }
    }

    /// Moves the time that `other`, if it runs, has measured into this one.
    #[inline]
    pub fn absorb(&mut self, other: &mut Self) {
        if !other.running {
            return;
        }
        for (spent, other) in self.spent.iter_mut().zip(&mut other.spent) {
            *spent += std::mem::take(other);
        }
    }

    /// Returns the time spent in each part.
    pub fn spent(&self) -> &[Duration; N] {
        &self.spent
    }
}

/// The timed parts of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolvePart {
    /// The choice of the starting point, and the check whether it is good enough.
    Start,
    /// The assembly of H.
    Hessian,
    /// The factorization of H, or its update.
    Factorization,
    /// The computation of the direction.
    Direction,
    /// The line search.
    LineSearch,
    /// Costs and gradient at the new point, and the stopping conditions.
    Evaluation,
}

impl SolvePart {
    /// The number of parts.
    pub const COUNT: usize = 6;
}

/// A stopwatch for the parts of solves.
pub type SolveClock = Stopwatch<{ SolvePart::COUNT }>;
