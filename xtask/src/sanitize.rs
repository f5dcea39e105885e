//! `cargo xtask sanitize`: the Rust tests under AddressSanitizer.

use crate::fuzz::host;
use crate::run::{cargo, run, target};

/// Runs the Rust tests with every access to memory checked; `args` go to `cargo test`, to choose some.
///
/// The checks are an unstable option of a stable compiler, which `RUSTC_BOOTSTRAP` opens; the runtime comes with it.
///
/// # Errors
/// A test that failed, a bad access to memory, or a compiler without the runtime.
pub(crate) fn sanitize(args: &[String]) -> Result<(), String> {
    let mut test = cargo(&["test", "--target", &host()?]);
    match args {
        [] => test.args(["--workspace", "--exclude", "clench-python"]),
        _ => test.args(args),
    };
    // Documentation tests are linked without the runtime.
    test.args(["--lib", "--bins", "--tests"]);
    test.arg("--target-dir").arg(target().join("sanitizer"));
    test.env("RUSTC_BOOTSTRAP", "1");
    test.env("RUSTFLAGS", "-Zsanitizer=address");
    run(test)
}
