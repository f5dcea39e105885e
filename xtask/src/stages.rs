//! The stages of `cargo xtask test`, in order, and `cargo xtask bench`.

use crate::gpu;
use crate::package;
use crate::python;
use crate::run::{ALL_FEATURES, Profile, cargo, command, run};
use crate::unit;
use crate::web;
use std::time::Instant;

/// One check: its name on the command line, what to do when it fails, and how to run it.
struct Stage {
    name: &'static str,
    remedy: &'static str,
    /// Given how programs are compiled that it runs.
    check: fn(Profile) -> Result<(), String>,
    /// Why it cannot run on this machine, if it cannot.
    missing: fn() -> Option<String>,
}

/// From cheap to dear, so that most mistakes show early.
const STAGES: &[Stage] = &[
    Stage {
        name: "fmt",
        remedy: "run `cargo fmt --all`",
        check: |_| fmt(),
        missing: nothing,
    },
    Stage {
        name: "page",
        remedy: "see the message above",
        check: |_| web::build(),
        missing: web::no_node,
    },
    Stage {
        name: "clippy",
        remedy: "mend the warnings above",
        check: |_| clippy(),
        missing: nothing,
    },
    Stage {
        name: "unit",
        remedy: "run the failing crate alone with `cargo test -p CRATE`",
        check: |_| unit::test(),
        missing: nothing,
    },
    Stage {
        name: "doc",
        remedy: "mend the documentation comments named above",
        check: |_| doc(),
        missing: nothing,
    },
    Stage {
        name: "build",
        remedy: "mend the errors above",
        check: build,
        missing: nothing,
    },
    Stage {
        name: "browser",
        remedy: "run one case alone in web/ with `CLENCH=../target/debug/clench NAME='part of its name' npm test`",
        check: web::test,
        missing: web::no_browser,
    },
    Stage {
        name: "python",
        remedy: "see the message above",
        check: |_| python::prepare(),
        missing: nothing,
    },
    Stage {
        name: "gpu",
        remedy: "run one test alone with `cargo test -p clench-gpu NAME`",
        check: |_| gpu::test(),
        missing: gpu::no_device,
    },
    Stage {
        name: "package",
        remedy: "see the message above",
        check: package::check,
        missing: nothing,
    },
    Stage {
        name: "pytest",
        remedy: "run one case alone with `.venv/bin/python -m pytest python/tests -k NAME`",
        check: package::test,
        missing: nothing,
    },
    Stage {
        name: "parity",
        remedy: "run one case alone with `CLENCH=target/debug/clench .venv/bin/python -m pytest parity -k NAME`",
        check: parity,
        missing: nothing,
    },
];

/// Runs all stages, or those named, up to the first that fails. With `--release` among the arguments the program and the Python package are
/// compiled as users have them.
///
/// # Errors
/// The failing stage with its remedy, or a name that is no stage.
pub(crate) fn test(args: &[String]) -> Result<(), String> {
    let (flags, names): (Vec<_>, Vec<_>) = args.iter().partition(|arg| *arg == "--release");
    let profile = match flags.is_empty() {
        true => Profile::Dev,
        false => Profile::Release,
    };
    if let Some(name) = names.iter().find(|n| STAGES.iter().all(|s| s.name != **n)) {
        return Err(format!("unknown stage `{name}`; see `cargo xtask --help`"));
    }
    let chosen: Vec<&Stage> = STAGES
        .iter()
        .filter(|s| names.is_empty() || names.iter().any(|n| *n == s.name))
        .collect();
    let begin = Instant::now();
    let mut summary = String::new();
    for (k, stage) in chosen.iter().enumerate() {
        println!("\n==> [{}/{}] {}", k + 1, chosen.len(), stage.name);
        if let Some(reason) = (stage.missing)() {
            println!("skipped: {reason}");
            summary += &format!("  {:<8}skipped: {reason}\n", stage.name);
            continue;
        }
        let start = Instant::now();
        let outcome = (stage.check)(profile);
        let seconds = start.elapsed().as_secs_f64();
        if let Err(message) = outcome {
            let left = chosen.len() - k - 1;
            return Err(format!(
                "\n{summary}  {:<8}FAILED  {seconds:6.1} s\n\n{message}\nStage `{}` failed: {}. {left} stages not run.",
                stage.name, stage.name, stage.remedy
            ));
        }
        summary += &format!("  {:<8}ok      {seconds:6.1} s\n", stage.name);
    }
    println!(
        "\n{summary}\nAll {} stages passed or were skipped, in {:.1} s.",
        chosen.len(),
        begin.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Times `clench` against MuJoCo; `args` go to the script.
///
/// # Errors
/// What could not be built, installed or run.
pub(crate) fn bench(args: &[String]) -> Result<(), String> {
    let profile = Profile::Dist;
    compile(profile, "clench-cli", ["--bin", "clench"])?;
    compile(profile, "clench", ["--example", "batch_step"])?;
    compile(profile, "clench-collide", ["--example", "pairs"])?;
    compile(profile, "clench-view", ["--example", "frames"])?;
    compile(profile, "clench-gpu", ["--example", "speed"])?;
    package::install(profile)?;
    let mut script = command(python::interpreter(), &["bench/speed.py"]);
    script.args(args).env("CLENCH", profile.program("clench"));
    script.env("BATCH_STEP", profile.program("examples/batch_step"));
    script.env("PAIRS", profile.program("examples/pairs"));
    script.env("FRAMES", profile.program("examples/frames"));
    script.env("SPEED", profile.program("examples/speed"));
    run(script)
}

/// What every machine can do that builds the rest.
fn nothing() -> Option<String> {
    None
}

fn fmt() -> Result<(), String> {
    run(cargo(&["fmt", "--all", "--check"]))
}

fn clippy() -> Result<(), String> {
    run(cargo(&[
        "clippy",
        "--quiet",
        "--workspace",
        "--features",
        ALL_FEATURES,
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ]))
}

fn doc() -> Result<(), String> {
    let mut doc = cargo(&["doc", "--quiet", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    run(doc)
}

/// The program, without the parts that are left out by default.
pub(crate) fn build(profile: Profile) -> Result<(), String> {
    compile(profile, "clench-cli", ["--bin", "clench"])
}

/// Builds a target of a package.
fn compile(profile: Profile, package: &str, target: [&str; 2]) -> Result<(), String> {
    let mut build = cargo(&["build", "--quiet", "--profile", profile.name()]);
    build.args(["--package", package]).args(target);
    run(build)
}

fn parity(profile: Profile) -> Result<(), String> {
    // Tests of the program with all its parts may have put theirs in its place.
    build(profile)?;
    let mut pytest = python::tests(&["parity"]);
    pytest.env("CLENCH", profile.program("clench"));
    run(pytest)
}
