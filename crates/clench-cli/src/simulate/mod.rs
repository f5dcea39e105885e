//! `clench simulate`: step a model through time and summarise the run.
//!
//! One environment goes through [`single`], many through [`batch`]; both give a [`report`].

mod batch;
mod display;
mod record;
mod report;
mod single;
mod start;
mod summary;

use crate::npy::{Rows, read_rows};
use crate::options::ModelArguments;
use anyhow::{Result, bail, ensure};
use batch::BatchArguments;
use clap::{Args, ValueEnum};
use clench::Model;
use indicatif::{ProgressBar, ProgressStyle};
use start::{StartArguments, Starts};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Steps the model from its initial state, or a keyframe, and prints a summary: speed of stepping alone, contacts and
/// solver iterations a step, the worst duality gap (how far a solution's cost may lie above the minimum, proven), the
/// worst penetration, and the energy drift where nothing in the model adds or removes energy. Of a batch also: how unlike
/// its environments are, memory, and the environments that failed, if any did.
#[derive(Args)]
#[command(after_help = RECORD)]
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
    /// Write time, qpos, qvel, ctrl, contact and solver statistics as NumPy arrays
    #[arg(long, value_name = "OUT.npz")]
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

    // Last, because its heading in the help holds for all that follows.
    #[command(flatten)]
    model: ModelArguments,
}

const RECORD: &str = "\
A record holds, a row for each recorded step: time, qpos, qvel and ctrl after the step; contacts, penetration (m),
iterations, gradient, improvement, gap and status of its solve (0 unconstrained, 1 proven by the gap, 2 converged,
3 no progress at the working precision, 4 iteration limit, 5 not finite). That of a batch holds time, qpos, qvel, ctrl,
contacts and iterations, environment by environment; one that has failed repeats its last good row.";

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
pub fn run(arguments: &Arguments) -> Result<()> {
    let (model, options) = arguments.model.load()?;
    let envs = arguments.batch.envs;
    let controls = arguments.ctrl.as_ref();
    let controls = controls.map(|path| read_rows("--ctrl", path, model.nu()));
    let controls = controls.transpose()?;
    let count = controls.as_ref().map(Rows::count);
    let run = Run {
        starts: arguments.start.starts(&model, envs.unwrap_or(1) as usize)?,
        steps: steps_to_take(arguments, model.params.timestep, count)?,
        model: Arc::clone(&model),
        controls,
    };
    let report = match (envs, arguments.precision) {
        (None, Bits::Double) => single::run::<f64>(arguments, &run, options)?,
        (None, Bits::Single) => single::run::<f32>(arguments, &run, options)?,
        (Some(envs), Bits::Double) => batch::run::<f64>(arguments, &run, envs, options)?,
        (Some(envs), Bits::Single) => batch::run::<f32>(arguments, &run, envs, options)?,
    };
    let mut out = io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string(&report)?)?;
    } else {
        write!(out, "{report}")?;
    }
    match report.failure {
        Some(message) => bail!(message),
        None => Ok(()),
    }
}

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
                steps < 1e15,
                "--time: {time} s are more steps than can be taken"
            );
            steps as usize
        }
        (None, None) => rows.unwrap_or((1.0 / timestep).round() as usize),
    };
    if let Some(rows) = rows {
        ensure!(
            wanted <= rows,
            "--ctrl: {rows} rows are too few for {wanted} steps"
        );
    }
    Ok(wanted)
}
