//! The stage `unit`: all Rust tests except those on a GPU, with a line for each test program to show the progress.
//! Other output of `cargo test` is shown if a test fails.

use crate::run::{ALL_FEATURES, Profile, shown};
use std::io::{BufRead, BufReader, pipe};
use std::process::Command;

/// Substrings of the names of tests that take from 8 s to a minute; a quick run omits them.
const LONG: [&str; 10] = [
    "accuracy::depths_and_normals_are_true",
    "closed_forms::a_cylinder_in_a_",
    "endurance::a_pinched_capsule_stays_for_a_minute_and_for_ten",
    "endurance::what_friction_carries_stands_for_ten_minutes",
    "distance::the_distance_is_true_and_its_points_lie_on_the_surfaces",
    "hostile::replicas_are_counted",
    "truth::the_deepest_point_is_the_true_distance",
    "a_pile_of_all_shapes_settles_in_its_bin",
    "accelerations_and_forces_agree_from_every_start",
    "minima_agree_and_the_gap_certifies_them",
];
/// The parts of this stage that a quick run omits.
pub(crate) const OMITTED_PARTS: &str = "clench-gpu, clench-render, clench-derivatives, examples of documentation, and the tests that xtask/src/unit.rs lists as long";

/// Builds and runs the tests.
///
/// # Errors
/// Returns an error if a build or a test fails.
pub(crate) fn test(profile: Profile) -> Result<(), String> {
    let mut programs = 0;
    // Examples have no tests: the stage `clippy` checks them.
    let mut build = tests(profile, "--tests");
    build.arg("--no-run");
    read_lines(build, |line| {
        if line.trim_start().starts_with("Executable") {
            programs += 1;
        } else if !is_foreign(line) {
            println!("{line}");
        }
    })?;
    let mut report = Report::new(programs);
    let mut outcome = Ok(());
    let kinds: &[&str] = match profile {
        Profile::Quick => &["--tests"],
        _ => &["--tests", "--doc"],
    };
    for kind in kinds {
        let mut tests = tests(profile, kind);
        if profile == Profile::Quick {
            tests.arg("--");
            tests.args(LONG.iter().flat_map(|name| ["--skip", name]));
        }
        outcome = read_lines(tests, |line| {
            if let Some(text) = report.read(line) {
                println!("{text}");
            }
        });
        if outcome.is_err() {
            break;
        }
    }
    println!("{}", report.other_output());
    outcome
}

fn tests(profile: Profile, kind: &str) -> Command {
    let mut tests = profile.cargo(&["test", kind]);
    tests.args(packages(profile));
    if profile != Profile::Quick {
        tests.args(["--features", ALL_FEATURES]);
    }
    tests.env("CLENCH_GPU", "skip");
    tests
}

/// Returns the arguments that select the packages of this stage.
pub(crate) fn packages(profile: Profile) -> Vec<String> {
    // Three of them need `wgpu`, which takes a minute and a half to compile. The step in dual numbers takes two.
    let omitted: &[&str] = match profile {
        Profile::Quick => &[
            "clench-gpu",
            "clench-render",
            "clench-python",
            "clench-derivatives",
        ],
        Profile::Dev | Profile::Release | Profile::Dist => &[],
    };
    let mut arguments = vec!["--workspace".to_owned()];
    arguments.extend(omitted.iter().map(|name| format!("--exclude={name}")));
    arguments
}

/// Returns true if the line is about an external crate; the project's own have a path.
fn is_foreign(line: &str) -> bool {
    let line = line.trim_start();
    ["Compiling ", "Downloaded ", "Fresh "]
        .iter()
        .any(|word| line.starts_with(word) && !line.contains(" (/"))
}

/// Runs a command to its end and passes each line of its output and errors on.
fn read_lines(mut command: Command, mut each: impl FnMut(&str)) -> Result<(), String> {
    let failed = |e: std::io::Error| format!("cannot run cargo: {e}");
    let (reader, writer) = pipe().map_err(failed)?;
    command.stdout(writer.try_clone().map_err(failed)?);
    command.stderr(writer);
    let text = shown(&command);
    let mut child = command.spawn().map_err(failed)?;
    // The command also holds ends of the pipe, so reading would never end.
    drop(command);
    for line in BufReader::new(reader).split(b'\n') {
        each(String::from_utf8_lossy(&line.map_err(failed)?).trim_end());
    }
    let status = child.wait().map_err(failed)?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("{status}: {text}")),
    }
}

/// The results of a run so far.
struct Report {
    /// The number of test programs, without documentation tests.
    programs: usize,
    begun: usize,
    /// The name of the running program.
    current: String,
    /// The output of the running program.
    printed: Vec<String>,
    passed: usize,
    failed: usize,
}

impl Report {
    fn new(programs: usize) -> Self {
        Report {
            programs,
            begun: 0,
            current: String::new(),
            printed: Vec::new(),
            passed: 0,
            failed: 0,
        }
    }

    /// Processes a line and returns the text to show for it, if any.
    fn read(&mut self, line: &str) -> Option<String> {
        let start = line.trim_start();
        if let Some(program) = start.strip_prefix("Running ") {
            self.begin(program_name(program));
            return None;
        }
        if let Some(of) = start.strip_prefix("Doc-tests ") {
            self.begin(format!("documentation of {of}"));
            return None;
        }
        let Some(result) = line.strip_prefix("test result: ") else {
            if !(line.is_empty() || line.ends_with(" ... ok") || start.starts_with("running ")) {
                self.printed.push(line.to_owned());
            }
            return None;
        };
        let passed = count(result, "passed");
        let failed = count(result, "failed");
        (self.passed, self.failed) = (self.passed + passed, self.failed + failed);
        let seconds = result.rsplit(' ').next().unwrap_or_default();
        let printed = std::mem::take(&mut self.printed);
        match (passed, failed) {
            (0, 0) => None,
            (_, 0) => Some(self.line(&format!("{passed:>4} passed in {seconds}"))),
            _ => Some(printed.join("\n") + "\n" + &self.line(&format!("{failed:>4} FAILED"))),
        }
    }

    fn begin(&mut self, program: String) {
        self.begun += 1;
        self.current = program;
    }

    fn line(&self, what: &str) -> String {
        let progress = format!("[{}/{}]", self.begun.min(self.programs), self.programs);
        format!("  {progress:<9} {what:<22} {}", self.current)
    }

    /// Returns the output that belongs to no result, such as compiler errors, and the totals.
    fn other_output(&self) -> String {
        let mut lines = self.printed.clone();
        lines.push(format!("{} passed, {} failed", self.passed, self.failed));
        lines.join("\n")
    }
}

/// Returns the name of a program from cargo's line: `tests/ik.rs (target/debug/deps/ik-0123)`.
fn program_name(text: &str) -> String {
    let (source, path) = text.split_once(" (").unwrap_or((text, ""));
    let file = path.trim_end_matches(')').rsplit('/').next();
    let name = file
        .and_then(|file| file.rsplit_once('-'))
        .map(|(name, _)| name);
    match (source.strip_prefix("unittests "), name) {
        (Some(_), Some(name)) => format!("{name}, inside"),
        (_, Some(_)) => source.to_owned(),
        _ => text.to_owned(),
    }
}

/// Returns the number before a word of `ok. 8 passed; 0 failed; ...`.
fn count(result: &str, word: &str) -> usize {
    let before = result.split(word).next().unwrap_or_default();
    let number = before.trim_end().rsplit(' ').next();
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::root;
    use std::fs;

    const RUN: &str = "\
     Running unittests src/lib.rs (target/debug/deps/clench_math-0a1b)

running 0 tests

test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s

     Running tests/lanes.rs (target/debug/deps/lanes-9f)

running 2 tests
test one ... ok
test other ... FAILED

failures:
assertion failed
test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.14s
   Doc-tests clench
running 3 tests
test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 1.50s";

    #[test]
    fn programs_with_tests_have_a_line_each() {
        let mut report = Report::new(2);
        let lines = Vec::from_iter(RUN.lines().filter_map(|line| report.read(line)));
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(lines[0].contains("test other ... FAILED\nfailures:\nassertion failed\n"));
        assert!(!lines[0].contains("test one"));
        assert!(lines[0].contains("[2/2]") && lines[0].contains(" 1 FAILED"));
        assert!(lines[0].ends_with(" tests/lanes.rs"));
        assert!(lines[1].contains(" 3 passed in 1.50s"));
        assert!(lines[1].ends_with(" documentation of clench"));
        assert_eq!(report.other_output(), "4 passed, 1 failed");
    }

    #[test]
    fn the_tests_that_take_long_exist() {
        let mut folders = vec![root().join("crates")];
        let mut code = String::new();
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).expect("a folder").flatten() {
                let path = entry.path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|end| end == "rs") {
                    code += &fs::read_to_string(path).expect("code");
                }
            }
        }
        for name in LONG {
            let function = name.rsplit(':').next().expect("a name");
            assert!(code.contains(&format!("fn {function}")), "{name}");
        }
    }

    #[test]
    fn only_our_own_crates_are_shown_while_they_compile() {
        assert!(is_foreign("   Compiling libc v0.2.1"));
        assert!(!is_foreign(
            "   Compiling clench-math v0.1.0 (/home/one/clench/crates/clench-math)"
        ));
        assert!(!is_foreign("error: expected one of"));
    }
}
