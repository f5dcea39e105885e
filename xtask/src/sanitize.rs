//! `cargo xtask sanitize`: the tests under AddressSanitizer, an unstable option of a stable compiler, enabled by
//! `RUSTC_BOOTSTRAP`.

use crate::fuzz::host;
use crate::python;
use crate::run::{Profile, cargo, command, root, run, target};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs the Rust tests with every memory access checked; `args` go to `cargo test`, to select some. `python` selects
/// the tests of the Python package, and the following arguments go to pytest.
///
/// # Errors
/// Returns an error if a test fails, a memory access is invalid, or the compiler lacks the runtime.
pub(crate) fn sanitize(args: &[String]) -> Result<(), String> {
    if let [first, rest @ ..] = args
        && first == "python"
    {
        return sanitize_python(rest);
    }
    let mut test = instrumented("test")?;
    match args {
        [] => test.args(["--workspace", "--exclude", "clench-python"]),
        _ => test.args(args),
    };
    // Documentation tests are linked without the runtime.
    test.args(["--lib", "--bins", "--tests"]);
    // Some tests leak the data that their shapes borrow.
    test.env("ASAN_OPTIONS", "detect_leaks=0");
    run(test)
}

/// Creates an instrumented cargo command.
fn instrumented(subcommand: &str) -> Result<Command, String> {
    let mut cargo = cargo(&[subcommand, "--target", &host()?]);
    cargo.arg("--target-dir").arg(folder());
    cargo.env("RUSTC_BOOTSTRAP", "1");
    cargo.env("RUSTFLAGS", "-Zsanitizer=address");
    Ok(cargo)
}

/// Returns the folder of all instrumented builds.
fn folder() -> PathBuf {
    target().join("sanitizer")
}

/// Tests the Python package: its compiled module is placed in a copy of the package. The interpreter is not
/// instrumented, so the sanitizer's runtime (GCC's) is preloaded.
fn sanitize_python(args: &[String]) -> Result<(), String> {
    python::prepare()?;
    let mut build = instrumented("build")?;
    build.args([
        "--package",
        "clench-python",
        "--features",
        "gpu,render,derivatives",
    ]);
    run(build)?;
    let compiled = folder().join(host()?).join("debug/libclench_python.so");
    let package = folder().join("python/clench");
    copy(&root().join("python/clench"), &package)?;
    copy(&compiled, &package.join("_core.abi3.so"))?;
    let mut tests = match args {
        // The memory of a loop cannot be measured, since freed memory is quarantined to detect later use.
        [] => python::tests(
            Profile::Dev,
            &["python/tests", "--ignore", "python/tests/test_leaks.py"],
        ),
        _ => python::tests(
            Profile::Dev,
            &args.iter().map(String::as_str).collect::<Vec<_>>(),
        ),
    };
    tests.env("PYTHONPATH", folder().join("python"));
    // External modules throw C++ exceptions, whose runtime must be loaded before the sanitizer starts.
    let before = [runtime("libasan.so")?, runtime("libstdc++.so")?];
    tests.env("LD_PRELOAD", before.join(" "));
    // The interpreter itself leaks memory at exit; arrays that are too large raise errors in Python.
    tests.env("ASAN_OPTIONS", "detect_leaks=0:allocator_may_return_null=1");
    run(tests)
}

/// Returns the path of one of GCC's runtime libraries.
fn runtime(name: &str) -> Result<String, String> {
    let missing = format!("GCC's {name} is missing: install g++");
    let found = command("gcc", &[format!("-print-file-name={name}").as_str()]).output();
    let found = found.map_err(|error| format!("{missing} ({error})"))?;
    let path = String::from_utf8_lossy(&found.stdout).trim().to_owned();
    // GCC prints the bare name of a file that it does not find.
    match Path::new(&path).is_absolute() {
        true => Ok(path),
        false => Err(missing),
    }
}

/// Copies a file, or a folder with its content.
fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error| format!("cannot copy {}: {error}", from.display());
    if !from.is_dir() {
        return fs::copy(from, to).map(drop).map_err(failed);
    }
    fs::create_dir_all(to).map_err(failed)?;
    for entry in fs::read_dir(from).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}
