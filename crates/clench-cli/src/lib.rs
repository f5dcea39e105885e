//! The `clench` program: `view`, `simulate`, `forward` and `inspect` a robot file, `convert` it to MJCF, and list the
//! supported MJCF (`mjcf`).
//!
//! There is one module per subcommand. They share options that override the file (`options`), atomic replacement of
//! files (`replacement`), signals (`interrupt`), messages (`message`), text tables (`table`), NumPy files (`npy`,
//! `zip`) and the JSON of states and results (`protocol`) with its limits (`limits`), which the fuzz targets also use.
//! The physics is in the library `clench`.
//!
//! This is a library because `rustc` compiles it in parallel to its dependencies, whereas a program waits for all of
//! them.

#![deny(unreachable_pub)]

mod allocator;
mod convert;
mod description;
mod exit;
mod forward;
mod inspect;
mod interrupt;
pub mod limits;
mod message;
mod mjcf;
pub mod npy;
mod options;
mod overrides;
pub mod protocol;
mod render;
mod replacement;
mod simulate;
pub mod state_line;
mod table;
mod view;
mod zip;

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use exit::{BAD_INPUT, is_closed_pipe};
use message::print_message;
use std::process::ExitCode;

/// Simulate articulated rigid bodies under contacts and other constraints, with MuJoCo's numbers
#[derive(Parser)]
#[command(name = "clench", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  clench view models/humanoid.xml
      show a moving robot in the browser, and drag it
  clench simulate models/humanoid.xml --time 2
      step a robot for two seconds and summarise what happened
  clench simulate models/pendulum.xml --steps 500 --record swing.npz --every 5
      record every fifth state as NumPy arrays
  clench simulate models/humanoid.xml --envs 1024 --noise 0.01 --precision 32
      step many robots in a batch, in single precision
  echo '{}' | clench forward models/quadruped.xml
      accelerations, contacts and constraint forces of the initial state, as JSON
  clench inspect models/four_bar.xml --steps 100
      sizes, tree, options, and the constraints that act after 100 steps
  clench convert models/gripper/gripper.urdf gripper.xml
      a URDF file, or any other model, as MJCF";

#[derive(Subcommand)]
enum Command {
    /// Show a simulation in the browser, and interact with it
    View(view::Arguments),
    /// Render an image or a video of a model, without a window
    Render(render::Arguments),
    /// Step a model through time and summarise the run
    Simulate(simulate::Arguments),
    /// Compute accelerations and forces of states: one JSON state a line in, one JSON result a line out
    Forward(forward::Arguments),
    /// Show a model: sizes, tree, options, and the constraints that act
    Inspect(inspect::Arguments),
    /// Write a model as MJCF, with every number resolved
    Convert(convert::Arguments),
    /// List the GPUs for `simulate --device gpu`
    #[command(long_flag = "list-devices")]
    Devices,
    /// List the parts of MJCF that are read, ignored and refused
    Mjcf(mjcf::Arguments),
}

/// Runs the program with the arguments of the process and returns its exit code.
#[must_use]
pub fn main() -> ExitCode {
    let matches = Arguments::command()
        .mut_subcommands(|command| command.mut_args(with_negative_numbers))
        .get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let result = match arguments.command {
        Command::View(arguments) => view::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Forward(arguments) => forward::run(&arguments).map(|()| ExitCode::SUCCESS),
        Command::Inspect(arguments) => inspect::run(&arguments).map(|()| ExitCode::SUCCESS),
        Command::Convert(arguments) => convert::run(&arguments).map(|()| ExitCode::SUCCESS),
        Command::Devices => simulate::list_devices().map(|()| ExitCode::SUCCESS),
        Command::Mjcf(arguments) => mjcf::run(&arguments).map(|()| ExitCode::SUCCESS),
    };
    match result {
        Ok(code) => code,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            print_message(format_args!("error: {error:#}"));
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// Lets an option take a negative number as its value, so that the error names the option.
fn with_negative_numbers(arg: Arg) -> Arg {
    let takes = !arg.is_positional() && arg.get_action().takes_values();
    arg.allow_negative_numbers(takes)
}

/// Returns the error of a program that was built without a feature: its purpose, and the command that enables it.
#[cfg(not(all(feature = "gpu", feature = "render")))]
fn without(feature: &str, does: &str) -> anyhow::Error {
    anyhow::anyhow!(
        "this program was built without the feature `{feature}`, which {does}; `cargo run --release --features {feature} -- ...` \
         builds one with it, which takes about two more minutes on two cores"
    )
}
