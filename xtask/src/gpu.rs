//! The GPU tests of `clench-gpu`, `clench-render` and the program's videos, on a GPU or on Mesa's software device.

use crate::install::try_to_install;
use crate::python;
use crate::run::{ALL_FEATURES, Profile, command, run, target};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// The folders in which Vulkan drivers register on Linux.
const DRIVERS: [&str; 2] = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// The compute tests, of `clench-gpu` and of the program, and the rendering tests.
const COMPUTING: [&str; 2] = ["device", "gpu"];
const DRAWING: [&str; 3] = ["silhouettes", "surfaces", "videos"];
/// Two groups of tests of `device` that run their kernels a few times: mostly those for any model in double precision,
/// and those specialized for a model in single precision. The others share the kernels for any model in single
/// precision, and run them for longer than Mesa's software device takes to optimize them. It compiles on one core per
/// program, so two programs run in parallel.
const BRIEF: [&[&str]; 2] = [
    &[
        "autoreset::",
        "discrete::",
        "double::",
        "random::",
        "sleep_combined::",
        "sleeping::",
        "stiction::",
    ],
    &[
        "batch::",
        "slots::",
        "stages::coulombs_law",
        "stages::kernels_of_a_models_own",
        "touch::",
        "outputs::those_of_bodies_in_contact_by_discrete",
    ],
];
/// The number of random models that are written for the tests.
const RANDOM_MODELS: usize = 200;
/// The number of random models of a soak.
const SOAKED_MODELS: usize = 5_000;
/// The distance between the first seeds of two soaks.
const SEED_DISTANCE: u64 = 1_000_000;

/// Runs the tests.
///
/// # Errors
/// Returns an error if a test fails.
pub(crate) fn test(profile: Profile) -> Result<(), String> {
    write_random_models(1, RANDOM_MODELS)?;
    let brief = |names: &[&str]| -> Result<Command, String> {
        let mut part = computing(profile, &COMPUTING[..1])?;
        part.arg("--").args(names);
        part.env("GALLIVM_PERF", "nopt");
        Ok(part)
    };
    let [first, second] = [brief(BRIEF[0])?, brief(BRIEF[1])?];
    // The remaining tests, and those of the program.
    let mut rest = computing(profile, &COMPUTING)?;
    rest.arg("--");
    for name in BRIEF.concat() {
        rest.args(["--skip", name]);
    }
    thread::scope(|scope| {
        let other = scope.spawn(|| run(first));
        let rest = run(rest).and_then(|()| run(second));
        let first = other.join();
        rest.and(first.unwrap_or_else(|_| Err("a part of the tests panicked".into())))
    })?;
    run(tests(profile, &DRAWING))
}

/// Compares many random models with the CPU.
///
/// # Errors
/// Returns an error if one differs.
pub(crate) fn soak(seed: u64) -> Result<(), String> {
    python::prepare()?;
    write_random_models(seed * SEED_DISTANCE, SOAKED_MODELS)?;
    let mut test = computing(Profile::Dev, &COMPUTING[..1])?;
    test.args(["--", "random::", "--nocapture"]);
    run(test)
}

/// Writes the random models of `count` seeds from `first` on.
fn write_random_models(first: u64, count: usize) -> Result<(), String> {
    let mut script = command(python::interpreter(), &["parity/write_random_models.py"]);
    script.arg(random_folder());
    script.args([first.to_string(), count.to_string()]);
    run(script)
}

fn random_folder() -> PathBuf {
    target().join("random-models")
}

/// Returns the command for these tests with the environment that compute tests need.
fn computing(profile: Profile, names: &[&str]) -> Result<Command, String> {
    let mut tests = tests(profile, names);
    tests.env("LP_NATIVE_VECTOR_WIDTH", "128");
    tests.env("CLENCH_GYMNASIUM", python::gymnasium_assets()?);
    tests.env("CLENCH_DM_CONTROL", python::dm_control_suite());
    tests.env("CLENCH_RANDOM_MODELS", random_folder());
    Ok(tests)
}

/// Returns the command for these tests, which the stage `unit` has compiled: it names all packages so that nothing is
/// recompiled with other features.
fn tests(profile: Profile, names: &[&str]) -> Command {
    let mut tests = profile.cargo(&["test", "--quiet", "--workspace"]);
    tests.args(["--features", ALL_FEATURES]);
    for name in names {
        tests.args(["--test", name]);
    }
    tests.env("CLENCH_GPU", "require");
    // The driver compiles debug lines of the shader text slowly.
    tests.env("WGPU_DEBUG", "0");
    // Mesa's device selection layer prints errors on stderr without a display.
    tests.env("NODEVICE_SELECT", "1");
    tests
}

/// Returns the reason if the tests cannot run here. Installs Mesa's drivers if permitted.
pub(crate) fn no_device() -> Option<String> {
    if !cfg!(target_os = "linux") || has_driver() {
        return None;
    }
    try_to_install("mesa-vulkan-drivers");
    let missing = "there is no driver for Vulkan; install that of your GPU, or Debian's package mesa-vulkan-drivers";
    (!has_driver()).then(|| missing.to_owned())
}

fn has_driver() -> bool {
    let files = |folder: &&str| Path::new(folder).read_dir().into_iter().flatten().count();
    DRIVERS.iter().any(|folder| files(folder) > 0)
}
