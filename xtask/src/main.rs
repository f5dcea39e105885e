//! The project's tasks: `cargo xtask test` checks everything, `cargo xtask bench` measures speed; `soak`, `fuzz`,
//! `sanitize` and `audit` are long searches for rare failures.

#![deny(unreachable_pub)]

mod audit;
mod docs;
mod estimate;
mod fuzz;
mod gpu;
mod install;
mod lanes;
mod notices;
mod others;
mod package;
mod python;
mod run;
mod sanitize;
mod size;
mod soak;
mod stages;
mod unit;
mod web;

use std::process::ExitCode;

const HELP: &str = "\
Clench's own chores.

Usage: cargo xtask COMMAND

Commands:
  test [--release | --quick] [STAGE...]
                    Check everything, or only the named stages, in this order:
                      fmt      rustfmt finds nothing to change
                      page     the viewer's page, built by Node; without npm skipped
                      clippy   no warnings in any crate, test or example
                      unit     all Rust tests but those on a graphics device
                      doc      rustdoc without warnings
                      build    the `clench` program, as the stages after it run it
                      size     the release program and Python module, which may not outgrow their limits; on 64-bit Linux
                      browser  the page driven in Chromium; without one skipped (CHROMIUM names another than /usr/bin/chromium)
                      python   .venv with MuJoCo and gymnasium
                      gpu      steps on a graphics device, or on Mesa's software device; without a driver skipped
                      package  the Python package, built and installed in .venv by pip; its types
                      pytest   its tests, every example in a short form among them
                      parity   `clench` against MuJoCo, with pytest
                    The program and the package are compiled as the Rust tests are, with their checks, for all instruction sets,
                    and lanes are tested in those that the processor has.
                    --release  compiles both as users have them, for this processor.
                    --quick    takes minutes: it compiles for this processor, and leaves out clippy, doc, size, browser, gpu, package
                               and pytest, and tests that take long. Named after it, clippy, package and pytest run in a
                               short form. It ends with a list of what it left out.
                    It says at each stage how long the rest will take, by the last such run (target/xtask-times).
  bench [ARG...]    Build `clench` with the `dist` profile, as it is shipped, and time it against MuJoCo.
                    Arguments go to bench/speed.py; try `cargo xtask bench --help`.
  soak [--only NAME] [SEED]
                    Look long for rare failures. `test` runs a short form of each. SOAK_SCALE=10 does a tenth of the steps.
                      models      compare 20,000 random models with MuJoCo; those that differ are cut down and kept in
                                  parity/differences
                      device      compare 5,000 random models on a graphics device, or Mesa's, with the processor
                      batch       step 10,000 environments 1,000 times under random controls, resets and poison; none may
                                  be lost, disturb another, or leak
                      endurance   the same, 10,000 times
                      resume      save a batch every 100 steps; what is resumed from there arrives where it would have
                      collide     a million poses of each pair of shapes, degenerate, huge, tiny and concentric ones;
                                  nothing may panic, hang, or be no number
                      recordings  end `clench simulate --record` by kill -9; no half a file may be left
  lanes             List the functions of the release program in which operations on lanes are calls: where a #[kernel] is missing.
  docs              Build the site in target/site: pages, notebooks, which are run, and the reference of the Python package.
  stubs             Install the Python package, and write the sections of its stub that follow from tables in Rust.
  wheel             Build the Python package that this machine can, in target/wheels, for all processors of its kind, with the
                    licences of what is compiled in.
  others [NAME]     Test the Python package beside large packages of others, which are installed below .venv:
                      ray       a batch on a cluster, whose workers are killed (500 MB)
                      learning  Stable-Baselines3 and TorchRL (5 GB)
  fuzz [--only TARGET] [--seconds N] [--address]
                    Search for bytes that break a reader, an hour each, with libFuzzer; needs a C++ compiler. --address checks
                    every access to memory. See docs/testing.md.
  sanitize [ARG...] Run the Rust tests under AddressSanitizer, or those that the arguments choose, which go to `cargo test`.
  sanitize python [ARG...]
                    The same for the tests of the Python package, with arguments of pytest; needs GCC's runtimes.
  audit             Licences, duplicate crates and advisories of dependencies; needs cargo-deny.

Needs Python 3.11 or later with venv. A package index must be reachable on the first run, and for the stage `package`.";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match args.first().map(String::as_str) {
        Some("test") => stages::test(&args[1..]),
        Some("bench") => stages::bench(&args[1..]),
        Some("soak") => soak::soak(&args[1..]),
        Some("lanes") => lanes::list(),
        Some("docs") => docs::build(),
        Some("stubs") => package::write_stubs(),
        Some("wheel") => notices::build(),
        Some("others") => others::test(&args[1..]),
        Some("fuzz") => fuzz::fuzz(&args[1..]),
        Some("sanitize") => sanitize::sanitize(&args[1..]),
        Some("audit") => audit::audit(),
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
