//! `cargo xtask sanitize`: the tests under AddressSanitizer, which is an unstable option of a stable compiler, opened by `RUSTC_BOOTSTRAP`.

use crate::fuzz::host;
use crate::python;
use crate::run::{Profile, cargo, command, root, run, target};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs the Rust tests with every access to memory checked; `args` go to `cargo test`, to choose some. `python` chooses those of the
/// Python package, and what follows it goes to pytest.
///
/// # Errors
/// A test that failed, a bad access to memory, or a compiler without the runtime.
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
    // Some tests keep what their shapes borrow to their end.
    test.env("ASAN_OPTIONS", "detect_leaks=0");
    run(test)
}

/// A command of cargo that compiles with checks.
fn instrumented(subcommand: &str) -> Result<Command, String> {
    let mut cargo = cargo(&[subcommand, "--target", &host()?]);
    cargo.arg("--target-dir").arg(folder());
    cargo.env("RUSTC_BOOTSTRAP", "1");
    cargo.env("RUSTFLAGS", "-Zsanitizer=address");
    Ok(cargo)
}

/// Where all that is compiled with checks lies.
fn folder() -> PathBuf {
    target().join("sanitizer")
}

/// The same for the Python package, whose compiled part is put beside a copy of its modules. An interpreter knows nothing of the checks, so
/// that their runtime, here that of GCC, is loaded before it.
fn sanitize_python(args: &[String]) -> Result<(), String> {
    python::prepare()?;
    let mut build = instrumented("build")?;
    build.args(["--package", "clench-python", "--features", "gpu,render"]);
    run(build)?;
    let compiled = folder().join(host()?).join("debug/libclench_python.so");
    let package = folder().join("python/clench");
    copy(&root().join("python/clench"), &package)?;
    copy(&compiled, &package.join("_core.abi3.so"))?;
    let mut tests = match args {
        // How much memory a loop takes is not told where freed memory is kept to see whether somebody uses it.
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
    // Modules of others throw exceptions of C++, whose runtime has to be there before the checks are.
    let before = [runtime("libasan.so")?, runtime("libstdc++.so")?];
    tests.env("LD_PRELOAD", before.join(" "));
    // The interpreter itself keeps memory to its end; arrays that are too large are errors of Python's.
    tests.env("ASAN_OPTIONS", "detect_leaks=0:allocator_may_return_null=1");
    run(tests)
}

/// One of GCC's runtimes.
fn runtime(name: &str) -> Result<String, String> {
    let missing = format!("GCC's {name} is not there: install g++");
    let found = command("gcc", &[format!("-print-file-name={name}").as_str()]).output();
    let found = found.map_err(|error| format!("{missing} ({error})"))?;
    let path = String::from_utf8_lossy(&found.stdout).trim().to_owned();
    // GCC gives the bare name of what it does not find.
    match Path::new(&path).is_absolute() {
        true => Ok(path),
        false => Err(missing),
    }
}

/// Copies a file, or a folder with all that is in it.
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
