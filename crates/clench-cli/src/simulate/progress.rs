//! The progress of a run: a line on standard error, if that is a terminal.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// The delay before the line appears, and its update interval.
const PERIOD: Duration = Duration::from_millis(500);
/// The width of the bar, characters.
const BAR: usize = 20;

/// A line that is updated during a run and cleared on drop.
pub(super) struct Progress {
    total: usize,
    start: Instant,
    shown: Instant,
    /// The number of characters on the terminal.
    letters: usize,
    terminal: bool,
}

impl Progress {
    /// Starts the progress of `total` steps.
    pub(super) fn new(total: usize) -> Self {
        let start = Instant::now();
        Progress {
            total,
            start,
            shown: start,
            letters: 0,
            terminal: io::stderr().is_terminal(),
        }
    }

    /// Reports that `steps` steps are done.
    pub(super) fn reach(&mut self, steps: usize) {
        if self.terminal && self.shown.elapsed() >= PERIOD {
            self.shown = Instant::now();
            self.show(&line(self.start.elapsed(), steps, self.total));
        }
    }

    /// Overwrites the last line. Spaces cover its remainder: not every terminal supports escape sequences.
    fn show(&mut self, line: &str) {
        let covered = self.letters;
        self.letters = line.len();
        // A failure to write is ignored.
        let _ = write!(io::stderr(), "\r{line:<covered$}");
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.letters > 0 {
            self.show("");
            self.show("");
        }
    }
}

/// Returns the line of a run that has taken `steps` steps in this time.
fn line(elapsed: Duration, steps: usize, total: usize) -> String {
    let seconds = elapsed.as_secs_f64();
    let share = steps as f64 / total.max(1) as f64;
    let bar = "#".repeat((share * BAR as f64) as usize);
    let remaining = Duration::try_from_secs_f64(seconds / share - seconds);
    let remaining = remaining.map_or("?".to_owned(), clock);
    let speed = steps as f64 / seconds;
    let elapsed = clock(elapsed);
    format!("{elapsed} [{bar:<BAR$}] {steps}/{total} steps, {speed:.0}/s, {remaining} left")
}

/// Formats a time as hours, minutes and seconds.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    let [hours, minutes, seconds] = [seconds / 3600, seconds / 60 % 60, seconds % 60];
    format!("{hours:02}:{minutes:02}:{seconds:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_shows_the_progress_of_a_run() {
        let after = |seconds, steps, total| line(Duration::from_secs(seconds), steps, total);
        assert_eq!(
            after(90, 250, 1000),
            "00:01:30 [#####               ] 250/1000 steps, 3/s, 00:04:30 left"
        );
        assert_eq!(
            after(3600, 10, 10),
            "01:00:00 [####################] 10/10 steps, 0/s, 00:00:00 left"
        );
        assert!(after(1, 0, 10).ends_with("0/s, ? left"));
    }
}
