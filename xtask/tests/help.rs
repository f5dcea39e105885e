//! The help of a command needs no builds and no packages.

use std::process::Command;

fn xtask(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    // A command that builds or installs anything fails with these.
    let output = command
        .args(arguments)
        .env("PIP_NO_INDEX", "1")
        .env("CARGO", "false")
        .output();
    let output = output.expect("the program can be run");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn the_help_of_the_bench_is_that_of_its_script() {
    for flag in ["-h", "--help"] {
        assert!(xtask(&["bench", flag]).contains("--batch-steps"));
    }
}

#[test]
fn every_command_has_help() {
    let help = xtask(&["--help"]);
    for command in [
        "test", "soak", "lanes", "docs", "stubs", "wheel", "others", "fuzz", "sanitize", "audit",
    ] {
        assert_eq!(xtask(&[command, "--help"]), help);
    }
}
