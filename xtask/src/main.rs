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
Tests, benches and other tasks of Clench.

Usage: cargo xtask COMMAND

Commands:
  test [--release | --quick] [STAGE...]
                    Run all tests, or only the named stages, in this order:
                      fmt      rustfmt changes nothing
                      page     build the viewer's page; skipped without npm
                      clippy   no warnings in any crate, test or example
                      unit     all Rust tests except those of the GPU
                      doc      rustdoc without warnings
                      build    build the `clench` program for the stages after it
                      size     size limits of the release program and the Python module; 64-bit Linux
                      browser  drive the page in Chromium; skipped without one (CHROMIUM names it)
                      python   create .venv with MuJoCo and gymnasium
                      gpu      tests of the GPU, or of Mesa's software device; skipped without a driver
                      package  build the Python package and install it in .venv; check its types
                      pytest   its tests, with every example in a short form
                      parity   compare `clench` with MuJoCo
                    The program and the package are compiled like the Rust tests, with debug checks, for all instruction
                    sets; lanes are tested for those that the processor has.
                    --release  compiles both as users do, for this processor.
                    --quick    takes minutes: it compiles for this processor and omits clippy, doc, size, browser, gpu,
                               package, pytest, and tests that take long. If you name clippy, package or pytest after
                               it, they run in a short form. It lists what it omitted.
                    Each stage prints the remaining time, from the last such run (target/xtask-times).
  bench [ARG...]    Build `clench` with the `dist` profile and time it against MuJoCo. Arguments go to bench/speed.py; see
                    `cargo xtask bench --help`.
  soak [--only NAME] [SEED]
                    Search for rare failures for hours. `test` runs a short form of each. SOAK_SCALE=10 runs a tenth of the steps.
                      models      compare 20,000 random models with MuJoCo; those that differ are minimized and stored in
                                  parity/differences
                      device      compare 5,000 random models on a GPU, or Mesa's device, with the processor
                      derivatives compare derivatives of 20 states of each public model with MuJoCo's differences, for all
                                  integrators
                      batch       step 10,000 environments 1,000 times under random controls, resets and poison; none may
                                  be lost, disturb another, or leak
                      endurance   the same, 10,000 times
                      resume      save a batch every 100 steps; a resumed run must arrive where the original does
                      collide     a million poses of each pair of shapes, degenerate, huge, tiny and concentric ones
                                  included; none may panic, hang, or return NaN
                      recordings  end `clench simulate --record` by kill -9; no partial file may remain
  lanes             List the functions of the release program that call operations on lanes: they lack a #[kernel].
  docs              Build the site in target/site: pages, executed notebooks, and the reference of the Python package.
  stubs             Install the Python package, and write the sections of its stub that are generated from tables in Rust.
  wheel             Build a Python wheel in target/wheels, for all processors of this kind, with the licences of its crates.
  others [NAME]     Test the Python package with large packages, which are installed below .venv:
                      ray       a batch on a cluster whose workers are killed (500 MB)
                      learning  Stable-Baselines3, TorchRL, PyTorch, JAX and UniSim (5 GB)
                      lerobot   LeRobot, with Python 3.12 or later (5 GB)
  fuzz [--only TARGET] [--seconds N] [--address]
                    Fuzz the readers, an hour each, with libFuzzer; needs a C++ compiler. --address adds AddressSanitizer.
                    See docs/testing.md.
  sanitize [ARG...] Run the Rust tests under AddressSanitizer; arguments go to `cargo test`.
  sanitize python [ARG...]
                    Run the tests of the Python package under AddressSanitizer; arguments go to pytest. Needs GCC's runtimes.
  audit             Check licences, duplicate crates and advisories of dependencies; needs cargo-deny.

Needs Python 3.11 or later with venv. The first run, and the stage `package`, need a package index.";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let wants_help = matches!(args.get(1).map(String::as_str), Some("-h" | "--help"));
    let outcome = match args.first().map(String::as_str) {
        // The options of the bench are those of its script.
        Some(command) if wants_help && command != "bench" => {
            println!("{HELP}");
            Ok(())
        }
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
