//! The stages of `cargo xtask test`, in order, and `cargo xtask bench`.

use crate::estimate::{Times, format_duration};
use crate::gpu;
use crate::package;
use crate::python;
use crate::run::{ALL_FEATURES, Profile, cargo, command, run};
use crate::size;
use crate::unit;
use crate::web;
use std::time::Instant;

/// A check: its name on the command line, the remedy of a failure, and the function that runs it.
struct Stage {
    name: &'static str,
    remedy: &'static str,
    /// The function; its argument is the profile of the programs that it runs.
    check: fn(Profile) -> Result<(), String>,
    /// The reason if it cannot run on this machine.
    missing: fn() -> Option<String>,
    quick: Quick,
}

/// The part of a stage that a quick run covers.
#[derive(PartialEq)]
enum Quick {
    All,
    /// All except this.
    Without(&'static str),
    /// Skipped unless the stage is named: then all except this.
    Named(&'static str),
    Nothing,
}

/// The stages from cheap to expensive, so that most errors show early.
const STAGES: &[Stage] = &[
    Stage {
        name: "fmt",
        remedy: "run `cargo fmt --all`",
        check: |_| fmt(),
        missing: no_requirement,
        quick: Quick::All,
    },
    Stage {
        name: "page",
        remedy: "see the message above",
        check: |_| web::build(),
        missing: web::no_node,
        quick: Quick::All,
    },
    Stage {
        name: "clippy",
        remedy: "fix the warnings above",
        check: clippy,
        missing: no_requirement,
        quick: Quick::Named(""),
    },
    Stage {
        name: "unit",
        remedy: "run the failing crate alone with `CLENCH_INSTRUCTIONS=all cargo test -p CRATE`",
        check: unit::test,
        missing: no_requirement,
        quick: Quick::Without(unit::OMITTED_PARTS),
    },
    Stage {
        name: "doc",
        remedy: "fix the documentation comments named above",
        check: doc,
        missing: no_requirement,
        quick: Quick::Nothing,
    },
    Stage {
        name: "build",
        remedy: "fix the errors above",
        check: build,
        missing: no_requirement,
        quick: Quick::All,
    },
    Stage {
        name: "size",
        remedy: "find what has grown with `cargo xtask lanes` or a tool such as cargo-bloat, or raise the limit in xtask/src/size.rs and say why",
        check: |_| size::check(),
        missing: size::no_elf,
        quick: Quick::Nothing,
    },
    Stage {
        name: "browser",
        remedy: "run one case alone in web/ with `CLENCH=../target/debug/clench NAME='part of its name' npm test`",
        check: web::test,
        missing: web::no_browser,
        quick: Quick::Nothing,
    },
    Stage {
        name: "python",
        remedy: "see the message above",
        check: |_| python::prepare(),
        missing: no_requirement,
        quick: Quick::All,
    },
    Stage {
        name: "gpu",
        remedy: "run one test alone with `CLENCH_INSTRUCTIONS=all cargo test -p clench-gpu NAME`",
        check: gpu::test,
        missing: gpu::no_device,
        quick: Quick::Nothing,
    },
    Stage {
        name: "package",
        remedy: "see the message above",
        check: package::check,
        missing: no_requirement,
        quick: Quick::Named(""),
    },
    Stage {
        name: "pytest",
        remedy: "run one case alone with `.venv/bin/python -m pytest python/tests -k NAME`",
        check: package::test,
        missing: no_requirement,
        quick: Quick::Named(
            "tests marked as long (leaks, random calls, examples), a graphics device, the page of a loop in Python",
        ),
    },
    Stage {
        name: "parity",
        remedy: "run one case alone with `CLENCH=target/debug/clench .venv/bin/python -m pytest parity -k NAME`",
        check: parity,
        missing: no_requirement,
        quick: Quick::Without("tests marked as long (long motions, random models)"),
    },
];

/// Runs all stages, or the named ones, up to the first failure. With the argument `--release`, the program and the
/// Python package are compiled as for users; with `--quick`, long parts are skipped.
///
/// # Errors
/// Returns an error if a stage fails, with its remedy, or a name is unknown.
pub(crate) fn test(args: &[String]) -> Result<(), String> {
    let (flags, names): (Vec<&str>, Vec<&str>) =
        (args.iter().map(String::as_str)).partition(|arg| arg.starts_with("--"));
    let profile = match flags[..] {
        [] => Profile::Dev,
        ["--release"] => Profile::Release,
        ["--quick"] => Profile::Quick,
        _ => return Err("test takes --release or --quick; see `cargo xtask --help`".to_owned()),
    };
    let chosen = choose(&names, profile)?;
    let begin = Instant::now();
    let mut times = Times::read(profile);
    let expected = |times: &Times, stages: &[&Stage]| -> f64 {
        stages.iter().map(|stage| times.seconds(stage.name)).sum()
    };
    let source = match times.has_records(chosen.iter().map(|stage| stage.name)) {
        true => "as the last such run did",
        false => "estimated from the number of processors",
    };
    println!(
        "This takes about {}, {source}.",
        format_duration(expected(&times, &chosen))
    );
    let mut summary = String::new();
    for (k, stage) in chosen.iter().enumerate() {
        let remaining = format_duration(expected(&times, &chosen[k..]));
        println!(
            "\n==> [{}/{}] {} (about {remaining} left)",
            k + 1,
            chosen.len(),
            stage.name
        );
        if let Some(reason) = (stage.missing)() {
            println!("skipped: {reason}");
            summary += &format!("  {:<8}skipped: {reason}\n", stage.name);
            continue;
        }
        let start = Instant::now();
        let outcome = (stage.check)(profile);
        let seconds = start.elapsed().as_secs_f64();
        if let Err(message) = outcome {
            let remaining = chosen.len() - k - 1;
            return Err(format!(
                "\n{summary}  {:<8}FAILED  {seconds:6.1} s\n\n{message}\nStage `{}` failed: {}. {remaining} stages not run.",
                stage.name, stage.name, stage.remedy
            ));
        }
        times.record(stage.name, seconds);
        summary += &format!("  {:<8}ok      {seconds:6.1} s\n", stage.name);
    }
    println!(
        "\n{summary}\nAll {} stages passed or were skipped, in {:.1} s.",
        chosen.len(),
        begin.elapsed().as_secs_f64()
    );
    if profile == Profile::Quick {
        println!("{}", omitted(&names));
    }
    Ok(())
}

/// Returns the stages of these names, or all of a run.
fn choose(names: &[&str], profile: Profile) -> Result<Vec<&'static Stage>, String> {
    let is_quick = profile == Profile::Quick;
    for name in names {
        match STAGES.iter().find(|stage| stage.name == *name) {
            None => return Err(format!("unknown stage `{name}`; see `cargo xtask --help`")),
            Some(stage) if is_quick && stage.quick == Quick::Nothing => {
                return Err(format!(
                    "a quick run omits `{name}`: run it without --quick"
                ));
            }
            Some(_) => {}
        }
    }
    let is_chosen = |stage: &&Stage| match names {
        [] => !(is_quick && matches!(stage.quick, Quick::Nothing | Quick::Named(_))),
        names => names.contains(&stage.name),
    };
    Ok(STAGES.iter().filter(is_chosen).collect())
}

/// Returns a text with the parts that a quick run of these stages, or of all, omits.
fn omitted(names: &[&str]) -> String {
    let mut text = String::from("This quick run omitted, and `cargo xtask test` includes:");
    for stage in STAGES {
        let is_named = names.contains(&stage.name);
        let what = match stage.quick {
            Quick::Without(what) if is_named || names.is_empty() => what,
            Quick::Named(what) if is_named => what,
            Quick::Named(_) if names.is_empty() => "all of it, unless it is named",
            Quick::Nothing if names.is_empty() => "all of it",
            _ => "",
        };
        if !what.is_empty() {
            text += &format!("\n  {:<8}{what}", stage.name);
        }
    }
    text + "\n  lanes of other instruction sets than the widest of this processor"
}

/// Benchmarks `clench` against MuJoCo; `args` go to the script.
///
/// # Errors
/// Returns an error if a build, an installation or the script fails.
pub(crate) fn bench(args: &[String]) -> Result<(), String> {
    if args.iter().any(|arg| arg == "--help" || arg == "-h") {
        let mut script = command("python3", &["bench/speed.py"]);
        script.args(args);
        return run(script);
    }
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
    // MuJoCo uses a windowless renderer on Linux only if this variable requests it.
    if cfg!(target_os = "linux") && std::env::var_os("MUJOCO_GL").is_none() {
        script.env("MUJOCO_GL", "egl");
    }
    // Mesa's device selection layer prints errors on stderr without a display.
    script.env("NODEVICE_SELECT", "1");
    run(script)
}

/// Returns `None`, for stages without further requirements.
fn no_requirement() -> Option<String> {
    None
}

fn fmt() -> Result<(), String> {
    run(cargo(&["fmt", "--all", "--check"]))
}

fn clippy(profile: Profile) -> Result<(), String> {
    let mut clippy = profile.cargo(&["clippy", "--quiet", "--workspace"]);
    clippy.args(["--features", ALL_FEATURES]);
    clippy.args(["--all-targets", "--", "-D", "warnings"]);
    run(clippy)
}

fn doc(profile: Profile) -> Result<(), String> {
    // With the features of the other checks, so that dependencies are not checked again.
    let mut doc = profile.cargo(&["doc", "--quiet", "--workspace", "--no-deps"]);
    doc.args(["--features", ALL_FEATURES]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    run(doc)
}

/// Builds the program with the default features.
pub(crate) fn build(profile: Profile) -> Result<(), String> {
    match profile {
        // Dependencies have the features that the tests' packages select together, so they are not compiled again.
        Profile::Dev | Profile::Quick => {
            let mut build = profile.cargo(&["build", "--quiet", "--bin", "clench"]);
            build.args(unit::packages(profile));
            run(build)
        }
        Profile::Release | Profile::Dist => compile(profile, "clench-cli", ["--bin", "clench"]),
    }
}

/// Builds a target of a package.
fn compile(profile: Profile, package: &str, target: [&str; 2]) -> Result<(), String> {
    let mut build = profile.cargo(&["build", "--quiet", "--profile", profile.name()]);
    build.args(["--package", package]).args(target);
    run(build)
}

fn parity(profile: Profile) -> Result<(), String> {
    // Tests of the program with all features may have replaced it.
    build(profile)?;
    let mut pytest = python::tests(profile, &["parity"]);
    pytest.env("CLENCH", profile.program("clench"));
    run(pytest)
}
