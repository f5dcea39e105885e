//! `clench simulate`: step a model through time and summarise the run.
//!
//! One environment goes through [`single`], many through [`batch`]; both give a [`report`].

mod batch;
mod display;
mod energy;
#[cfg(feature = "gpu")]
pub mod gpu;
mod page;
mod quality;
mod record;
mod report;
mod single;
mod start;
mod summary;

use crate::interrupt::Interrupt;
use crate::limits::{MAX_DEFAULT_STEPS, MAX_STEPS, MemoryArguments};
use crate::message::tell;
use crate::npy::{Rows, read_rows};
use crate::options::ModelArguments;
use crate::replacement::require_other;
use anyhow::{Context, Result, bail, ensure};
use batch::{BatchArguments, DeviceName};
use clap::{Args, ValueEnum};
use clench::Model;
use indicatif::{ProgressBar, ProgressStyle};
use record::RecordOptions;
use serde::Serialize;
pub use start::StartArguments;
use start::Starts;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

/// Steps the model from its initial state, or a keyframe, and prints a summary: speed of stepping alone, contacts and
/// solver iterations a step, the worst duality gap (how far a solution's cost may lie above the minimum, proven), the
/// worst penetration, and the energy drift where nothing in the model adds or removes energy. Of a batch also: how unlike
/// its environments are, memory, and the environments that failed, if any did. A word says what the run is worth, see below;
/// what is wrong with it also comes as warnings on standard error.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub struct Arguments {
    /// Steps to take [default: one simulated second, or as many as --ctrl has rows]
    #[arg(long, value_name = "N", conflicts_with = "time")]
    steps: Option<usize>,
    /// Seconds to simulate
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,
    /// Controls as a NumPy array (N, nu): row k for step k, the same in every environment
    #[arg(long, value_name = "FILE.npy")]
    ctrl: Option<PathBuf>,
    /// Write time, qpos, qvel, ctrl, contact and solver statistics as NumPy arrays (`.npz`), or a page that replays the run in a
    /// browser (`.html`, of one environment), in place of an old file once all is done
    #[arg(long, value_name = "OUT")]
    record: Option<PathBuf>,
    /// Record every K-th step
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = at_least_one)]
    every: usize,
    /// Bits of a number
    #[arg(long, value_name = "BITS", default_value = "64")]
    precision: Bits,
    /// Tell the time of each stage of a step; reading the clocks adds to it
    #[arg(long)]
    profile: bool,
    /// Print the summary as one JSON object, the last line of the output
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    start: StartArguments,

    #[command(flatten)]
    batch: BatchArguments,

    #[command(flatten)]
    memory: MemoryArguments,

    // Last, because its heading in the help holds for all that follows.
    #[command(flatten)]
    model: ModelArguments,
}

const DETAILS: &str = "\
A record holds, a row for each recorded step: time, qpos, qvel and ctrl after the step; contacts, penetration (m),
iterations, gradient, improvement, gap and status of its solve (0 unconstrained, 1 proven by the gap, 2 converged,
3 no progress at the working precision, 4 iteration limit, 5 not finite). That of a batch holds time, qpos, qvel, ctrl,
contacts and iterations, environment by environment; one that has failed repeats its last good row.

The quality of a run is `good`, or the gravest of:
  energy_growth         mechanical energy rose by more than twice what actuators put in and what lifting each body by its own
                        radius of gyration takes, and a fifth of the kinetic energy (not judged where mocap bodies, gravity
                        compensation or wind may give energy too)
  deep_penetration      in more than 1% of the steps a contact was deeper than half the thickness of one of its geoms,
                        and deeper than its softness explains: at rest under its force, or in an impact at 5 m/s
  constraint_violation  in more than 5% of the steps an equality or a limit was violated by more than 0.1 (m or rad),
                        and by more than its softness explains
  unconverged           the solves of more than 1% of the steps stopped at the iteration limit

Ctrl-C (SIGINT) and SIGTERM end a run after the step it is in: the record is written, the summary says `interrupted`, and the
exit code is 130 or 143. A second one ends the program at once, without a record. The exit code is 2 for bad input and for
runs that failed.";

#[derive(Clone, Copy, ValueEnum)]
enum Bits {
    #[value(name = "64")]
    Double,
    #[value(name = "32")]
    Single,
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("it must be at least 1".into()),
        Ok(number) => Ok(number),
        Err(error) => Err(error.to_string()),
    }
}

/// What a run is told, read and checked.
struct Run<'a> {
    model: Arc<Model>,
    starts: Starts<'a>,
    controls: Option<Rows>,
    steps: usize,
    record: Option<RecordOptions<'a>>,
    interrupt: Interrupt,
}

impl Run<'_> {
    /// A bar on standard error that appears once a run has lasted a while, and only on a terminal.
    fn progress(&self) -> ProgressBar {
        let bar = ProgressBar::new(self.steps as u64);
        let style = ProgressStyle::with_template(
            "{elapsed_precise} [{wide_bar}] {pos}/{len} steps, {per_sec}, {eta} left",
        );
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        bar
    }
}

/// Runs the simulation, writes the record, prints the summary.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let (model, options) = arguments.model.load()?;
    let envs = arguments.batch.envs;
    let limit = arguments.memory.limit();
    if let Some(path) = &arguments.record {
        let inputs = [
            ("the model", Some(arguments.model.file.model.as_path())),
            ("--ctrl", arguments.ctrl.as_deref()),
            ("--states", arguments.start.states()),
        ];
        require_other(("--record", path), &inputs)?;
    }
    let controls = arguments.ctrl.as_ref();
    let controls = controls.map(|path| read_rows("--ctrl", path, model.nu(), limit));
    let controls = controls.transpose()?;
    let count = controls.as_ref().map(Rows::count);
    let steps = steps_to_take(arguments, model.params.timestep, count)?;
    let run = Run {
        starts: (arguments.start).starts(&model, envs.unwrap_or(1) as usize, limit)?,
        steps,
        model: Arc::clone(&model),
        controls,
        record: arguments.record.as_ref().map(|path| RecordOptions {
            path,
            every: arguments.every,
            rows: steps / arguments.every,
            limit,
        }),
        interrupt: Interrupt::listen()?,
    };
    if let (DeviceName::Gpu, Some(envs)) = (arguments.batch.device, envs) {
        return on_device(arguments, &run, envs as usize, options);
    }
    let mut report = match (envs, arguments.precision) {
        (None, Bits::Double) => single::run::<f64>(arguments, &run, options)?,
        (None, Bits::Single) => single::run::<f32>(arguments, &run, options)?,
        (Some(envs), Bits::Double) => batch::run::<f64>(arguments, &run, envs, options)?,
        (Some(envs), Bits::Single) => batch::run::<f32>(arguments, &run, envs, options)?,
    };
    // A run that was over before the signal came was not interrupted.
    let signal =
        (run.interrupt.signal()).filter(|_| report.failure.is_none() && report.steps < steps);
    if signal.is_some() {
        report.status = "interrupted";
    }
    for warning in &report.warnings {
        tell(format_args!("warning: {warning}"));
    }
    let printed = print(arguments, &report);
    if let Some(message) = report.failure {
        bail!(message);
    }
    if let Some(signal) = signal {
        let (name, done) = (signal.name, report.steps);
        let recorded = match (&arguments.record, report.recorded_rows) {
            (Some(path), Some(rows)) => format!(", {rows} rows are recorded in {}", path.display()),
            _ => String::new(),
        };
        tell(format_args!(
            "interrupted by {name}: {done} of {steps} steps are done{recorded}"
        ));
        return Ok(ExitCode::from(signal.exit_code()));
    }
    printed?;
    Ok(ExitCode::SUCCESS)
}

/// Runs on a graphics device.
#[cfg(feature = "gpu")]
fn on_device(
    arguments: &Arguments,
    run: &Run,
    envs: usize,
    options: clench::RigidOptions,
) -> Result<ExitCode> {
    let report = gpu::run(arguments, run, envs, options)?;
    print(arguments, &report)?;
    if report.failed() {
        return Ok(ExitCode::from(crate::BAD_INPUT));
    }
    let code = run.interrupt.signal().map(|signal| signal.exit_code());
    Ok(code.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Says how to get a program that can.
#[cfg(not(feature = "gpu"))]
fn on_device(_: &Arguments, _: &Run, _: usize, _: clench::RigidOptions) -> Result<ExitCode> {
    bail!(
        "--device gpu: this program was built without it; build with `cargo run --release --features gpu --`"
    )
}

fn print(arguments: &Arguments, report: &(impl Serialize + ToString)) -> Result<()> {
    let mut out = io::stdout().lock();
    let text = if arguments.json {
        format!("{}\n", serde_json::to_string(report)?)
    } else {
        report.to_string()
    };
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.context("standard output")
}

/// How many steps a run has, where a file of controls has so many rows.
fn steps_to_take(arguments: &Arguments, timestep: f64, rows: Option<usize>) -> Result<usize> {
    let wanted = match (arguments.steps, arguments.time) {
        (Some(steps), _) => steps,
        (None, Some(time)) => {
            ensure!(
                time.is_finite() && time >= 0.0,
                "--time: {time} is not a number of seconds"
            );
            let steps = (time / timestep).round();
            ensure!(
                steps < MAX_STEPS,
                "--time: {time} s in steps of {timestep} s are {steps:.3e} steps, more than the {MAX_STEPS:.0e} that can be taken"
            );
            steps as usize
        }
        (None, None) => match rows {
            Some(rows) => rows,
            None => {
                let steps = (1.0 / timestep).round();
                ensure!(
                    steps <= MAX_DEFAULT_STEPS,
                    "one second in steps of {timestep:e} s is {steps:.3e} steps, more than the {MAX_DEFAULT_STEPS:.0e} that are \
                     taken unasked: choose with --steps or --time"
                );
                steps as usize
            }
        },
    };
    if let Some(rows) = rows {
        ensure!(
            wanted <= rows,
            "--ctrl: {rows} rows are too few for {wanted} steps"
        );
    }
    Ok(wanted)
}
