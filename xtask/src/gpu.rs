//! The tests of `clench-gpu`, of `clench-render` and of the films of the program, on a graphics device or on Mesa's software device.

use crate::install::try_to_install;
use crate::python;
use crate::run::{ALL_FEATURES, Profile, command, run, target};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// Where drivers for Vulkan register on Linux.
const DRIVERS: [&str; 2] = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// Those that compute, of `clench-gpu` and of the program, and those that draw.
const COMPUTING: [&str; 2] = ["device", "gpu"];
const DRAWING: [&str; 3] = ["silhouettes", "surfaces", "films"];
/// Tests of `device` that take about as long as all that is left: most compile kernels of their own, what is left shares kernels for any model. Mesa's
/// software device compiles on one core for each program, so that they run side by side.
const PART: [&str; 5] = ["batch::", "outputs::", "double::", "random::", "steps::"];
/// Random models that are written for them.
const RANDOM_MODELS: usize = 200;
/// Random models of a soak, and how far its seeds are apart.
const SOAKED_MODELS: usize = 5_000;
const APART: u64 = 1_000_000;

/// Runs them.
///
/// # Errors
/// That a test failed.
pub(crate) fn test(profile: Profile) -> Result<(), String> {
    write_random_models(1, RANDOM_MODELS)?;
    let mut part = computing(profile, &COMPUTING[..1])?;
    part.arg("--").args(PART);
    // What is left, and the program's.
    let mut rest = computing(profile, &COMPUTING)?;
    rest.arg("--");
    for name in PART {
        rest.args(["--skip", name]);
    }
    thread::scope(|scope| {
        let beside = scope.spawn(|| run(part));
        let rest = run(rest);
        let part = beside.join();
        rest.and(part.unwrap_or_else(|_| Err("a part of the tests panicked".into())))
    })?;
    run(tests(profile, &DRAWING))
}

/// Compares many random models with the processor.
///
/// # Errors
/// That one differs.
pub(crate) fn soak(seed: u64) -> Result<(), String> {
    python::prepare()?;
    write_random_models(seed * APART, SOAKED_MODELS)?;
    let mut test = computing(Profile::Dev, &COMPUTING[..1])?;
    test.args(["--", "random::", "--nocapture"]);
    run(test)
}

/// Writes the random models of so many seeds, from one on.
fn write_random_models(first: u64, count: usize) -> Result<(), String> {
    let mut script = command(python::interpreter(), &["parity/write_random_models.py"]);
    script.arg(random_folder());
    script.args([first.to_string(), count.to_string()]);
    run(script)
}

fn random_folder() -> PathBuf {
    target().join("random-models")
}

/// The tests of these names, with what those that compute need.
fn computing(profile: Profile, names: &[&str]) -> Result<Command, String> {
    let mut tests = tests(profile, names);
    // Tests ask a few times for many kernels: Mesa's software device takes longer to optimize them than to run them as they are.
    tests.env("GALLIVM_PERF", "nopt");
    tests.env("LP_NATIVE_VECTOR_WIDTH", "128");
    tests.env("CLENCH_GYMNASIUM", python::gymnasium_assets()?);
    tests.env("CLENCH_DM_CONTROL", python::dm_control_suite());
    tests.env("CLENCH_RANDOM_MODELS", random_folder());
    Ok(tests)
}

/// Runs the tests of these names, which the stage `unit` has compiled: all packages are named, so that nothing is compiled anew for other features.
fn tests(profile: Profile, names: &[&str]) -> Command {
    let mut tests = profile.cargo(&["test", "--quiet", "--workspace"]);
    tests.args(["--features", ALL_FEATURES]);
    for name in names {
        tests.args(["--test", name]);
    }
    tests.env("CLENCH_GPU", "require");
    // Lines of the texts in what the driver compiles, which it takes its time over.
    tests.env("WGPU_DEBUG", "0");
    // A part of Mesa that would choose the device complains on stderr where there is no display.
    tests.env("NODEVICE_SELECT", "1");
    tests
}

/// Why they cannot run here, if they cannot. Where the tests may, they install Mesa's drivers.
pub(crate) fn no_device() -> Option<String> {
    if !cfg!(target_os = "linux") || has_driver() {
        return None;
    }
    try_to_install("mesa-vulkan-drivers");
    let missing = "there is no driver for Vulkan; install that of your card, or Debian's package mesa-vulkan-drivers";
    (!has_driver()).then(|| missing.to_owned())
}

fn has_driver() -> bool {
    let files = |folder: &&str| Path::new(folder).read_dir().into_iter().flatten().count();
    DRIVERS.iter().any(|folder| files(folder) > 0)
}
