//! The project's own chores: `cargo xtask test` checks everything, `cargo xtask bench` measures speed, `cargo xtask soak`
//! looks long for rare failures.

mod package;
mod python;
mod run;
mod stages;

use std::process::ExitCode;

const HELP: &str = "\
Clench's own chores.

Usage: cargo xtask COMMAND

Commands:
  test [STAGE...]   Check everything, or only the named stages, in this order:
                      fmt      rustfmt finds nothing to change
                      clippy   no warnings in any crate, test or example
                      unit     all Rust tests
                      doc      rustdoc without warnings
                      build    the release `clench` program
                      python   .venv with MuJoCo and gymnasium
                      package  the Python package, built and installed in .venv by pip; its types
                      pytest   its tests, every example in a short form among them
                      parity   `clench` against MuJoCo, with pytest
  bench [ARG...]    Build `clench` with the `dist` profile, as it is shipped, and time it against MuJoCo.
                    Arguments go to bench/speed.py; try `cargo xtask bench --help`.
  soak [--only NAME] [SEED]
                    batch: step 10,000 environments 1,000 times under random controls, resets and poison; none may
                    be lost, disturb another, or leak.
                    collide: a million poses of each pair of shapes, degenerate, huge, tiny and concentric ones;
                    nothing may panic, hang, or be no number.
                    `test` runs a short form of both.

Needs Python 3.11 or later with venv. A package index must be reachable on the first run, and for the stage `package`.";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match args.first().map(String::as_str) {
        Some("test") => stages::test(&args[1..]),
        Some("bench") => stages::bench(&args[1..]),
        Some("soak") => stages::soak(&args[1..]),
        Some("help" | "-h" | "--help") => {
            println!("{HELP}");
            Ok(())
        }
        Some(other) => Err(format!("unknown command `{other}`\n\n{HELP}")),
        None => Err(HELP.to_string()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
