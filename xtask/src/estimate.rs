//! Estimates of the duration of stages: the last duration on this machine, or else a duration measured elsewhere.

use crate::run::{Profile, target};
use std::fs;
use std::path::PathBuf;
use std::thread::available_parallelism;

/// The duration of a stage on one processor, s: with everything compiled, and the additional time with nothing
/// compiled. They are rough, because they apply only until the stage has run once.
const SECONDS: [(&str, f64, f64); 13] = [
    ("fmt", 5.0, 0.0),
    ("page", 25.0, 0.0),
    ("clippy", 30.0, 170.0),
    ("unit", 500.0, 1000.0),
    ("doc", 20.0, 30.0),
    ("build", 10.0, 40.0),
    ("size", 5.0, 420.0),
    ("browser", 300.0, 0.0),
    ("python", 5.0, 120.0),
    ("gpu", 1500.0, 0.0),
    ("package", 100.0, 70.0),
    ("pytest", 350.0, 0.0),
    ("parity", 450.0, 0.0),
];
/// The share of that duration for a quick run, of stages of which it omits a part.
const QUICK: [(&str, f64); 2] = [("unit", 0.65), ("parity", 0.9)];

/// The records of earlier runs, and the kind of this run.
pub(crate) struct Times {
    /// The profile, and whether anything was compiled before: runs that differ in these have different durations.
    kind: String,
    cores: f64,
    quick: bool,
    cold: bool,
    /// The kind of run, the stage and its duration, s.
    records: Vec<(String, String, f64)>,
}

impl Times {
    /// Reads the records of earlier runs, for a run with this profile.
    pub(crate) fn read(profile: Profile) -> Self {
        // Without a readable file, as in a first run, durations are estimated.
        let records = parse(&fs::read_to_string(file()).unwrap_or_default());
        let all_sets = |kind: &str| kind.starts_with("dev");
        let (last, now) = (records.last(), format!("{profile:?}").to_lowercase());
        let has_other_sets = last.is_some_and(|(kind, ..)| all_sets(kind) != all_sets(&now));
        let cold = has_other_sets || !has_kernels(profile);
        Times {
            kind: format!("{now}-{}", if cold { "cold" } else { "warm" }),
            cores: available_parallelism().map_or(1, usize::from) as f64,
            quick: profile == Profile::Quick,
            cold,
            records,
        }
    }

    /// Returns the expected duration of a stage, s.
    pub(crate) fn seconds(&self, stage: &str) -> f64 {
        let mut records = self.records.iter();
        if let Some((.., seconds)) =
            records.find(|(kind, name, _)| *kind == self.kind && name == stage)
        {
            return *seconds;
        }
        let mut shares = QUICK
            .iter()
            .filter(|(name, _)| self.quick && *name == stage);
        let share = shares.next().map_or(1.0, |(_, share)| *share);
        let mut all = SECONDS.iter().filter(|(name, ..)| *name == stage);
        all.next().map_or(0.0, |(_, warm, more)| {
            share / self.cores * (warm + if self.cold { *more } else { 0.0 })
        })
    }

    /// Returns true if all of these stages have run on this machine with this kind of run.
    pub(crate) fn has_records<'a>(&self, mut stages: impl Iterator<Item = &'a str>) -> bool {
        let has = |stage| {
            (self.records.iter()).any(|(kind, name, _)| *kind == self.kind && name == stage)
        };
        stages.all(has)
    }

    /// Records the duration of a stage for the next run.
    pub(crate) fn record(&mut self, stage: &str, seconds: f64) {
        let is_old = |kind: &str, name: &str| kind == self.kind && name == stage;
        self.records.retain(|(kind, name, _)| !is_old(kind, name));
        self.records
            .push((self.kind.clone(), stage.to_owned(), seconds));
        // Without the file the next run uses estimates, which fails no test.
        let _ = fs::write(file(), text(&self.records));
    }
}

fn file() -> PathBuf {
    target().join("xtask-times")
}

/// Returns true if the kernels, which take most of the compile time, are compiled.
fn has_kernels(profile: Profile) -> bool {
    let entries = fs::read_dir(profile.folder().join(".fingerprint"));
    let mut names = entries.into_iter().flatten().flatten();
    names.any(|entry| {
        entry
            .file_name()
            .to_string_lossy()
            .starts_with("clench-dynamics-")
    })
}

/// Parses a file with a line for each stage of each kind of run.
fn parse(text: &str) -> Vec<(String, String, f64)> {
    let line = |line: &str| {
        let mut words = line.split_whitespace();
        let (kind, stage) = (words.next()?, words.next()?);
        let seconds: f64 = words.next()?.parse().ok()?;
        seconds
            .is_finite()
            .then(|| (kind.to_owned(), stage.to_owned(), seconds))
    };
    text.lines().filter_map(line).collect()
}

fn text(records: &[(String, String, f64)]) -> String {
    let line =
        |(kind, stage, seconds): &(String, String, f64)| format!("{kind} {stage} {seconds:.1}\n");
    records.iter().map(line).collect()
}

/// Formats a time: `40 s`, `7 min`.
pub(crate) fn format_duration(seconds: f64) -> String {
    match seconds {
        ..90.0 => format!("{seconds:.0} s"),
        _ => format!("{:.0} min", seconds / 60.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(text: &str) -> Times {
        Times {
            kind: "dev-warm".to_owned(),
            cores: 2.0,
            quick: false,
            cold: false,
            records: parse(text),
        }
    }

    #[test]
    fn the_estimate_of_a_stage_is_from_a_run_of_the_same_kind() {
        let times = times("dev-cold unit 700.0\ndev-warm unit 123.4\nnonsense\ndev-warm doc NaN\n");
        assert_eq!(times.seconds("unit"), 123.4);
        assert_eq!(times.records.len(), 2);
        assert!(times.has_records(["unit"].into_iter()));
        assert!(!times.has_records(["unit", "doc"].into_iter()));
    }

    #[test]
    fn a_stage_that_has_not_run_is_guessed_by_processors() {
        let mut times = times("");
        let warm = times.seconds("unit");
        assert!(warm > 0.0);
        times.cold = true;
        assert!(times.seconds("unit") > warm);
        let all = times.seconds("unit");
        times.quick = true;
        assert!(times.seconds("unit") < all);
        times.cores = 4.0;
        assert!(times.seconds("fmt") > 0.0 && times.seconds("fmt") < 4.0);
    }

    #[test]
    fn written_times_are_read_again() {
        let records = times("dev-warm unit 123.4\nquick-cold fmt 1.0\n").records;
        assert_eq!(parse(&text(&records)), records);
    }

    #[test]
    fn durations_are_in_seconds_or_minutes() {
        assert_eq!(format_duration(41.7), "42 s");
        assert_eq!(format_duration(400.0), "7 min");
    }
}
