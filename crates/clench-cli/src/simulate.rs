//! `clench simulate`: step a model through time and summarise the run.

use crate::options::ModelArguments;
use crate::record::{self, Recorder};
use crate::summary::Summary;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use clench::Sim;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Steps the model from its initial state, or a keyframe, and prints a summary: speed of stepping alone, contacts and
/// solver iterations a step, the worst duality gap (how far a solution's cost may lie above the minimum, proven), the
/// worst penetration, and the energy drift where nothing in the model adds or removes energy.
#[derive(Args)]
#[command(after_help = RECORD)]
pub struct Arguments {
    /// Steps to take [default: one simulated second, or as many as --ctrl has rows]
    #[arg(long, value_name = "N", conflicts_with = "time")]
    steps: Option<usize>,
    /// Seconds to simulate
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,
    /// Controls as a NumPy array (N, nu): row k for step k
    #[arg(long, value_name = "FILE.npy")]
    ctrl: Option<PathBuf>,
    /// Start from this keyframe (name or index)
    #[arg(long, value_name = "K")]
    keyframe: Option<String>,
    /// Write time, qpos, qvel, ctrl, contact and solver statistics as NumPy arrays
    #[arg(long, value_name = "OUT.npz")]
    record: Option<PathBuf>,
    /// Record every K-th step
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Threads; one environment uses one
    #[arg(long, value_name = "T", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    threads: u64,
    /// Print the summary as one JSON object, the last line of the output
    #[arg(long)]
    json: bool,

    // Last, because its heading in the help holds for all that follows.
    #[command(flatten)]
    model: ModelArguments,
}

const RECORD: &str = "\
A record holds, a row for each recorded step: time, qpos, qvel and ctrl after the step; contacts, penetration (m),
iterations, gradient, improvement, gap and status of its solve (0 unconstrained, 1 proven by the gap, 2 converged,
3 no progress at the working precision, 4 iteration limit, 5 not finite).";

/// Runs the simulation, writes the record, prints the summary.
pub fn run(arguments: &Arguments) -> Result<()> {
    let mut sim = arguments.model.sim()?;
    if let Some(key) = &arguments.keyframe {
        sim.reset_to_keyframe(find_keyframe(&sim, key)?)?;
    }
    let controls = match &arguments.ctrl {
        Some(path) => Some(
            record::read_rows(path, sim.model().nu())
                .with_context(|| format!("--ctrl {}", path.display()))?,
        ),
        None => None,
    };
    let steps = steps_to_take(arguments, &sim, controls.as_ref().map(|c| c.count()))?;
    let mut recorder = match &arguments.record {
        Some(path) => Some(
            Recorder::create(path, &sim, arguments.every)
                .with_context(|| format!("--record {}", path.display()))?,
        ),
        None => None,
    };
    let mut summary = Summary::new(&mut sim)?;
    let progress = progress_bar(steps);
    let mut seconds = 0.0;
    for step in 0..steps {
        if let Some(rows) = &controls {
            sim.state.ctrl.copy_from_slice(rows.row(step));
        }
        let start = Instant::now();
        let result = sim.step();
        seconds += start.elapsed().as_secs_f64();
        if let Err(error) = result {
            progress.abandon();
            summary.failed(step, &error);
            break;
        }
        summary.after_step(&sim);
        if let Some(recorder) = &mut recorder {
            recorder.after_step(step, &sim);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let (Some(recorder), Some(path)) = (recorder, &arguments.record) {
        recorder
            .write()
            .with_context(|| format!("--record {}", path.display()))?;
    }
    let report = summary.finish(&mut sim, seconds);
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

/// A bar on standard error that appears once a run has lasted a while, and only on a terminal.
fn progress_bar(steps: usize) -> ProgressBar {
    let bar = ProgressBar::new(steps as u64);
    let style = ProgressStyle::with_template(
        "{elapsed_precise} [{wide_bar}] {pos}/{len} steps, {per_sec}, {eta} left",
    );
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

fn find_keyframe(sim: &Sim, key: &str) -> Result<usize> {
    let keyframes = &sim.model().keyframes;
    if let Some(k) = keyframes.iter().position(|k| k.name == key) {
        return Ok(k);
    }
    match key.parse::<usize>() {
        Ok(k) if k < keyframes.len() => Ok(k),
        _ if keyframes.is_empty() => bail!("--keyframe {key}: the model has no keyframes"),
        _ => {
            let names: Vec<_> = keyframes.iter().map(|k| k.name.as_str()).collect();
            bail!(
                "--keyframe {key}: not a name or an index of the model's {} keyframes ({})",
                names.len(),
                names.join(", ")
            )
        }
    }
}

fn steps_to_take(arguments: &Arguments, sim: &Sim, rows: Option<usize>) -> Result<usize> {
    let timestep = sim.params().timestep;
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
