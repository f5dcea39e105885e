//! `clench simulate`: step a model through time and summarise the run.
//!
//! A single environment is stepped by [`single`], several by [`batch`]; both return a [`report`].

mod arguments;
mod batch;
mod display;
mod energy;
#[cfg(feature = "gpu")]
pub(crate) mod gpu;
mod messages;
mod page;
mod progress;
mod quality;
mod record;
mod report;
mod rollout;
mod run;
mod single;
mod start;
mod summary;

use crate::interrupt::Interrupt;
use crate::limits::{MAX_DEFAULT_STEPS, steps_in};
use crate::message::print_message;
use crate::npy::{Rows, read_rows};
use crate::replacement::require_other;
use anyhow::{Context, Result, bail, ensure};
pub(crate) use arguments::Arguments;
use arguments::{Bits, DeviceName};
use record::RecordOptions;
use run::Run;
use serde::Serialize;
pub(crate) use start::StartArguments;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;

/// Runs the simulation, writes the record and prints the summary.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let (model, options) = arguments.model.load()?;
    let envs = arguments.batch.envs;
    let others = arguments.batch.other_model.iter();
    let others = others.map(|path| arguments.model.load_as_well(path));
    let models = [Ok(Arc::clone(&model))].into_iter().chain(others);
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
    let steps = step_count(arguments, model.params.timestep, count)?;
    let run = Run {
        starts: (arguments.start).starts(&model, envs.unwrap_or(1) as usize, limit)?,
        steps,
        model: Arc::clone(&model),
        models: models.collect::<Result<_>>()?,
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
        ensure!(
            run.models.len() == 1,
            "--other-model: a GPU steps one model"
        );
        return on_device(arguments, &run, envs as usize, options);
    }
    let mut report = match (envs, arguments.precision.unwrap_or(Bits::Double)) {
        (None, Bits::Double) => single::run::<f64>(arguments, &run, options)?,
        (None, Bits::Single) => single::run::<f32>(arguments, &run, options)?,
        (Some(envs), Bits::Double) => batch::run::<f64>(arguments, &run, envs, options)?,
        (Some(envs), Bits::Single) => batch::run::<f32>(arguments, &run, envs, options)?,
    };
    // A signal after the end of the run does not count.
    let signal =
        (run.interrupt.signal()).filter(|_| report.failure.is_none() && report.steps < steps);
    if signal.is_some() {
        report.status = "interrupted";
    }
    for warning in &report.warnings {
        print_message(format_args!("warning: {warning}"));
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
        print_message(format_args!(
            "interrupted by {name}: {done} of {steps} steps are complete{recorded}"
        ));
        return Ok(ExitCode::from(signal.exit_code()));
    }
    printed?;
    Ok(ExitCode::SUCCESS)
}

/// Runs on a GPU.
#[cfg(feature = "gpu")]
fn on_device(
    arguments: &Arguments,
    run: &Run,
    envs: usize,
    options: clench::RigidOptions,
) -> Result<ExitCode> {
    let report = match arguments.precision.unwrap_or(Bits::Single) {
        Bits::Double => gpu::run::<f64>(arguments, run, envs, options)?,
        Bits::Single => gpu::run::<f32>(arguments, run, envs, options)?,
    };
    print(arguments, &report)?;
    if report.failed() {
        return Ok(ExitCode::from(crate::exit::BAD_INPUT));
    }
    let code = run.interrupt.signal().map(|signal| signal.exit_code());
    Ok(code.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Lists the GPUs of this machine.
#[cfg(feature = "gpu")]
pub(crate) fn list_devices() -> Result<()> {
    gpu::list()
}

#[cfg(not(feature = "gpu"))]
fn on_device(_: &Arguments, _: &Run, _: usize, _: clench::RigidOptions) -> Result<ExitCode> {
    Err(no_devices())
}

#[cfg(not(feature = "gpu"))]
pub(crate) fn list_devices() -> Result<()> {
    Err(no_devices())
}

#[cfg(not(feature = "gpu"))]
fn no_devices() -> anyhow::Error {
    crate::without("gpu", "steps batches on GPUs")
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

/// Returns the number of steps of a run; `rows` is the row count of the controls, if given.
fn step_count(arguments: &Arguments, timestep: f64, rows: Option<usize>) -> Result<usize> {
    let steps = match (arguments.steps, arguments.time) {
        (Some(steps), _) => steps,
        (None, Some(time)) => {
            ensure!(
                time.is_finite() && time >= 0.0,
                "--time: {time} must be finite and not negative"
            );
            steps_in(time, timestep)?
        }
        (None, None) => match rows {
            Some(rows) => rows,
            None => {
                let steps = (1.0 / timestep).round();
                ensure!(
                    steps <= MAX_DEFAULT_STEPS,
                    "one second in steps of {timestep:e} s is {steps:.3e} steps, more than the default maximum of \
                     {MAX_DEFAULT_STEPS:.0e}: set --steps or --time"
                );
                steps as usize
            }
        },
    };
    if let Some(rows) = rows {
        ensure!(
            steps <= rows,
            "--ctrl: {rows} rows are too few for {steps} steps"
        );
    }
    Ok(steps)
}
