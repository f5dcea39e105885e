//! The viewer's page: its build by Node, and its tests in a browser.

use crate::install::try_to_install;
use crate::python::interpreter;
use crate::run::{Profile, command, root, run};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Builds the page, which the program and the Python package embed when they are compiled later.
///
/// # Errors
/// Returns an error if a package is not available or the page has type errors.
pub(crate) fn build() -> Result<(), String> {
    npm(&["ci", "--silent", "--no-audit", "--no-fund"]).map_err(|e| {
        format!("{e}\nA registry of npm must be reachable, on the first run at least.")
    })?;
    npm(&["run", "--silent", "check"])?;
    npm(&["run", "--silent", "build"])
}

/// Tests the page in Chromium.
///
/// # Errors
/// Returns an error if a test fails.
pub(crate) fn test(profile: Profile) -> Result<(), String> {
    drive("test", profile)
}

/// Tests the page of a viewer that a Python loop feeds; the package must be installed.
///
/// # Errors
/// Returns an error if a test fails.
pub(crate) fn test_python(profile: Profile) -> Result<(), String> {
    drive("test:python", profile)
}

fn drive(script: &str, profile: Profile) -> Result<(), String> {
    let mut tests = in_web("npm", &["run", "--silent", script]);
    tests.env("CLENCH", profile.program("clench"));
    tests.env("PYTHON", interpreter());
    tests.env("CHROMIUM", chromium());
    run(tests)
}

/// Returns the reason if the page cannot be built here.
pub(crate) fn no_node() -> Option<String> {
    let installed = in_web("npm", &["--version"]).stdout(Stdio::null()).status();
    match installed {
        Ok(status) if status.success() => None,
        _ => Some("npm is not installed".to_owned()),
    }
}

/// Returns the reason if the page cannot be tested here. Installs Debian's Chromium if permitted.
pub(crate) fn no_browser() -> Option<String> {
    no_node().or_else(|| {
        let path = chromium();
        if !path.is_file() {
            try_to_install("chromium");
        }
        let missing = !path.is_file();
        missing.then(|| {
            format!(
                "there is no Chromium at {}; install Debian's package chromium, or set CHROMIUM to its path",
                path.display()
            )
        })
    })
}

/// Returns the path in the environment variable `CHROMIUM`, or else of Debian's Chromium.
fn chromium() -> PathBuf {
    std::env::var_os("CHROMIUM").map_or_else(|| "/usr/bin/chromium".into(), PathBuf::from)
}

fn npm(arguments: &[&str]) -> Result<(), String> {
    run(in_web("npm", arguments))
}

fn in_web(program: &str, arguments: &[&str]) -> Command {
    let mut command_in_web = command(program, arguments);
    command_in_web.current_dir(root().join("web"));
    command_in_web
}
