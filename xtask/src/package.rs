//! The Python package as users install it: built and installed by pip, type-checked and tested.

use crate::python::{self, interpreter, prepare};
use crate::run::{Profile, command, run, target};
use crate::web;
use std::process::Command;

/// Installs the package and checks its types against the installed module.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn check(profile: Profile) -> Result<(), String> {
    install(profile)?;
    let mypy = ["-m", "mypy", "--config-file", "python/pyproject.toml"];
    let mut types = command(interpreter(), &mypy);
    types.args([
        "python/clench",
        "python/examples",
        "python/tests",
        "python/lerobot_env_clench/lerobot_env_clench",
    ]);
    run(types)?;
    // Modules that need a package that is not installed here cannot be imported, and stubtest would report only that.
    let stubtest = [
        "-m",
        "mypy.stubtest",
        "clench",
        "--mypy-config-file=python/pyproject.toml",
        "--allowlist=python/needs-others.txt",
        "--ignore-unused-allowlist",
    ];
    run(command(interpreter(), &stubtest))
}

/// Builds the package and installs it in `.venv`, which is created if it is missing.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn install(profile: Profile) -> Result<(), String> {
    prepare()?;
    println!("building the package and installing it in .venv");
    let mut install = command(
        interpreter(),
        &["-m", "pip", "install", "--quiet", "./python[gymnasium]"],
    );
    compile_with(&mut install, profile);
    run(install).map_err(|e| {
        format!("{e}\nThis needs a package index: pip fetches maturin, which builds the package, every time.")
    })
}

/// Installs the package and writes the generated sections of its stub, which follow from tables in Rust.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn write_stubs() -> Result<(), String> {
    install(Profile::Release)?;
    run(command(interpreter(), &["python/tests/stubs.py"]))
}

/// Builds the package for distribution, for all processors of this architecture, in `target/wheels`.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn wheel() -> Result<(), String> {
    prepare()?;
    let mut build = command(
        interpreter(),
        &["-m", "pip", "wheel", "--no-deps", "./python"],
    );
    build.arg("--wheel-dir").arg(target().join("wheels"));
    compile_with(&mut build, Profile::Dist);
    run(build)
}

/// Sets the profile and the target folder of pip's build.
fn compile_with(pip: &mut Command, profile: Profile) {
    pip.arg(format!(
        "--config-settings=build-args=--profile={} --features=gpu,render,derivatives",
        profile.name()
    ));
    profile.choose_instructions(pip);
    // A relative path would name another folder, since pip builds in `python`.
    pip.env("CARGO_TARGET_DIR", target());
}

/// Runs the tests of the package, including every example in its short form; then tests a loop in Python through a
/// browser, if there is one.
///
/// # Errors
/// Returns an error if a test fails.
pub(crate) fn test(profile: Profile) -> Result<(), String> {
    let mut tests = python::tests(profile, &["-rs", "python/tests"]);
    if profile == Profile::Quick {
        tests.env("CLENCH_GPU", "skip");
        return run(tests);
    }
    run(tests)?;
    match web::no_browser() {
        None => web::test_python(profile),
        Some(reason) => {
            println!("skipped: the page of a loop in Python: {reason}");
            Ok(())
        }
    }
}
