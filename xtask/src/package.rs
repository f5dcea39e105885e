//! The Python package, as its users get it: built and installed by pip, its types checked, its tests run.

use crate::python::{self, interpreter, prepare};
use crate::run::{Profile, command, run, target};
use crate::web;
use std::process::Command;

/// Installs the package, and holds its types to what was installed.
///
/// # Errors
/// What failed, and what to check.
pub(crate) fn check(profile: Profile) -> Result<(), String> {
    install(profile)?;
    let mypy = ["-m", "mypy", "--config-file", "python/pyproject.toml"];
    let mut types = command(interpreter(), &mypy);
    types.args(["python/clench", "python/examples", "python/tests"]);
    run(types)?;
    // What needs a package that is not installed here cannot be imported, which is all that stubtest could see of it.
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

/// Builds the package and installs it in `.venv`, which is made if need be.
///
/// # Errors
/// What failed, and what to check.
pub(crate) fn install(profile: Profile) -> Result<(), String> {
    prepare()?;
    println!("building the package and installing it in .venv");
    let mut install = command(
        interpreter(),
        &["-m", "pip", "install", "--quiet", "./python[gymnasium]"],
    );
    compile_with(&mut install, profile);
    run(install).map_err(|e| {
        format!("{e}\nBesides cargo this needs a package index: pip fetches maturin, which builds the package, every time.")
    })
}

/// Installs the package, and writes the sections of its stub that follow from tables in Rust.
///
/// # Errors
/// What failed, and what to check.
pub(crate) fn write_stubs() -> Result<(), String> {
    install(Profile::Release)?;
    run(command(interpreter(), &["python/tests/stubs.py"]))
}

/// Builds the package for others to install, for all processors of this machine's kind, in `target/wheels`.
///
/// # Errors
/// What failed, and what to check.
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

/// Tells pip how the package is to be compiled, and where.
fn compile_with(pip: &mut Command, profile: Profile) {
    pip.arg(format!(
        "--config-settings=build-args=--profile={} --features=gpu,render",
        profile.name()
    ));
    profile.choose_instructions(pip);
    // A relative one would mean another folder there, as pip builds in `python`.
    pip.env("CARGO_TARGET_DIR", target());
}

/// Runs the tests of the package, and with them every example in its short form; then looks at a loop in Python through a browser, where
/// there is one.
///
/// # Errors
/// That a test failed.
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
