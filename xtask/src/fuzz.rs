//! `cargo xtask fuzz`: searches for input bytes that break a reader, by libFuzzer, on stable Rust.

use crate::run::{cargo, command, root, run, shown, target};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The targets, by the names of their folders in `fuzz/seeds`.
const TARGETS: [&str; 12] = [
    "mjcf", "urdf", "stl", "obj", "msh", "dae", "gltf", "png", "grid", "npy", "states", "contacts",
];

/// The compiler flags that report the executed code to libFuzzer: the coverage pass is part of stable Rust.
const COVERAGE: &str = "--cfg fuzzing -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

/// The parsed arguments of `fuzz`.
struct Plan<'a> {
    targets: Vec<&'a str>,
    seconds: u64,
    address: bool,
}

impl<'a> Plan<'a> {
    fn of(args: &'a [String]) -> Result<Self, String> {
        let mut plan = Plan {
            targets: TARGETS.to_vec(),
            seconds: 3600,
            address: false,
        };
        let mut args = args.iter().map(String::as_str);
        while let Some(arg) = args.next() {
            match arg {
                "--address" => plan.address = true,
                "--only" => {
                    let name = args.next().unwrap_or_default();
                    if !TARGETS.contains(&name) {
                        let known = TARGETS.join(", ");
                        return Err(format!("`{name}` is not a target; there are {known}"));
                    }
                    plan.targets = vec![name];
                }
                "--seconds" => {
                    let text = args.next().unwrap_or_default();
                    let number = text.parse().ok().filter(|seconds| *seconds > 0);
                    plan.seconds = number.ok_or("--seconds needs a whole number above 0")?;
                }
                _ => {
                    return Err(format!(
                        "fuzz takes --only, --seconds and --address, not `{arg}`"
                    ));
                }
            }
        }
        Ok(plan)
    }
}

/// Fuzzes the targets one after the other, up to the first with a finding.
///
/// # Errors
/// Returns an error if the arguments are invalid, the compiler lacks support, or a target has a finding.
pub(crate) fn fuzz(args: &[String]) -> Result<(), String> {
    let plan = Plan::of(args)?;
    let programs = build(plan.address)?;
    let dictionary = work().join("mjcf.dict");
    write(&dictionary, &mjcf_dictionary()?)?;
    let mut summary = String::new();
    for name in &plan.targets {
        let outcome = search(name, &programs.join(name), &dictionary, plan.seconds);
        let executions = outcome.map_err(|error| format!("{summary}{error}"))?;
        summary += &format!("{name:<9}{executions} executions in {} s\n", plan.seconds);
    }
    println!("{summary}Nothing was found.");
    Ok(())
}

/// Returns the folder of the fuzzer's programs and corpora.
fn work() -> PathBuf {
    target().join("fuzzer")
}

/// Returns the host triple of rustc: passing it explicitly builds build scripts and macros without instrumentation.
pub(crate) fn host() -> Result<String, String> {
    let output = command("rustc", &["-vV"]).output();
    let text = output.map_err(|error| format!("cannot start rustc: {error}"))?;
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or_else(|| "rustc does not print its target".into())
}

fn build(address: bool) -> Result<PathBuf, String> {
    let host = host()?;
    let mut build = cargo(&[
        "build",
        "--profile",
        "fuzz",
        "--package",
        "clench-fuzz",
        "--bins",
    ]);
    build.args(["--features", "libfuzzer", "--target", &host]);
    let folder = if address {
        work().join("address")
    } else {
        work()
    };
    build.arg("--target-dir").arg(&folder);
    let mut flags = COVERAGE.to_owned();
    if address {
        flags += " -Zsanitizer=address";
        build.env("RUSTC_BOOTSTRAP", "1");
    }
    build.env("RUSTFLAGS", flags);
    run(build)?;
    Ok(folder.join(host).join("fuzz"))
}

/// Runs a target and returns the number of executions of its body.
fn search(name: &str, program: &Path, dictionary: &Path, seconds: u64) -> Result<u64, String> {
    let corpus = work().join("corpus").join(name);
    let findings = root().join("fuzz/artifacts").join(name);
    for folder in [&corpus, &findings] {
        fs::create_dir_all(folder)
            .map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
    }
    let mut fuzzer = command(
        program,
        &["-rss_limit_mb=2048", "-timeout=10", "-print_final_stats=1"],
    );
    fuzzer.arg(format!("-max_total_time={seconds}"));
    fuzzer.arg(format!("-artifact_prefix={}/", findings.display()));
    // Readers open files, which are up to twenty times as fast in memory.
    let memory = Path::new("/dev/shm");
    if memory.is_dir() {
        fuzzer.env("TMPDIR", memory);
    }
    if name == "mjcf" {
        fuzzer.arg(format!("-dict={}", dictionary.display()));
    }
    fuzzer.arg(corpus);
    let mut seeds = vec![
        root().join("fuzz/seeds").join(name),
        root().join("fuzz/regressions").join(name),
    ];
    if name == "mjcf" {
        seeds.extend([root().join("models"), root().join("parity/models")]);
    }
    fuzzer.args(seeds.iter().filter(|folder| folder.is_dir()));
    println!("\n==> {name}");
    let shown = shown(&fuzzer);
    let mut child = (fuzzer.stderr(Stdio::piped()).spawn())
        .map_err(|error| format!("cannot start {shown}: {error}"))?;
    let mut executions = 0;
    for line in BufReader::new(child.stderr.take().expect("it was asked for")).lines() {
        let Ok(line) = line else { break };
        if let Some(number) = line.strip_prefix("stat::number_of_executed_units:") {
            executions = number.trim().parse().unwrap_or(0);
        }
        let _ = writeln!(std::io::stderr(), "{line}");
    }
    let status = child.wait().map_err(|error| error.to_string())?;
    if status.success() {
        return Ok(executions);
    }
    Err(format!(
        "{name} found something after {executions} executions: see above, and {}.\nMinimize it by `{} -minimize_crash=1 \
         -runs=100000 FILE`, fix the cause, and add it to fuzz/regressions/{name}.",
        findings.display(),
        program.display()
    ))
}

/// Builds a libFuzzer dictionary of the MJCF keywords from the reader's own rules.
fn mjcf_dictionary() -> Result<String, String> {
    let mut print = cargo(&["run", "--quiet", "--package", "clench-fuzz"]);
    print
        .args(["--example", "dictionary"])
        .stderr(Stdio::inherit());
    let printed = print
        .output()
        .map_err(|error| format!("cannot run {}: {error}", shown(&print)))?;
    match printed.status.success() {
        true => Ok(String::from_utf8_lossy(&printed.stdout).into_owned()),
        false => Err(format!("{} failed", shown(&print))),
    }
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_known_and_has_seeds() {
        let programs = fs::read_dir(root().join("fuzz/fuzz_targets")).expect("the targets");
        assert_eq!(programs.count(), TARGETS.len());
        for name in TARGETS {
            let program = format!("fuzz/fuzz_targets/{name}.rs");
            assert!(root().join(program).is_file(), "{name}");
            assert!(root().join("fuzz/seeds").join(name).is_dir(), "{name}");
        }
    }
}
