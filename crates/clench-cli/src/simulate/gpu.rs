//! A run of many environments on a graphics device.

use super::arguments::Arguments;
use super::report::Failure;
use super::run::Run;
use anyhow::{Result, bail, ensure};
use clench::{Batch, BatchOptions, RigidOptions};
use clench_gpu::{GpuBatch, GpuError, GpuOptions, GpuSolve};
use serde::Serialize;
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Steps between two looks at signals.
const STEPS_A_CALL: usize = 64;
/// How many failed environments a report names.
const NAMED_FAILURES: usize = 10;

/// The figures of a finished run.
#[derive(Serialize)]
pub struct GpuReport {
    /// `ok`, `interrupted` or `failed`, where an environment did.
    status: &'static str,
    device: String,
    /// Wall time of stepping alone, s.
    seconds: f64,
    steps: usize,
    envs: usize,
    /// Bits of a number.
    precision: usize,
    nv: usize,
    simulated_time: f64,
    steps_per_second: f64,
    bytes_per_env: usize,
    /// Over environments, of the last solve.
    iterations_mean: f64,
    contacts_mean: f64,
    failed_envs: usize,
    /// The first of them.
    failures: Vec<Failure>,
    /// Positions of the first environment at the end.
    qpos: Vec<f32>,
}

impl GpuReport {
    /// Whether some environment failed.
    pub fn failed(&self) -> bool {
        self.failed_envs > 0
    }
}

/// Lists the devices, in the order in which they are chosen.
///
/// # Errors
/// That there are none.
pub fn list() -> Result<()> {
    let all = clench_gpu::devices();
    ensure!(!all.is_empty(), GpuError::NoDevice);
    all.iter().for_each(|device| println!("{device}"));
    Ok(())
}

/// Steps many environments on the first device.
///
/// # Errors
/// No device; a model or an argument that is not for one.
pub(super) fn run(
    arguments: &Arguments,
    run: &Run,
    envs: usize,
    options: RigidOptions,
) -> Result<GpuReport> {
    if let Some(flag) = arguments.batch.of_processor() {
        bail!("{flag} is not for --device gpu");
    }
    ensure!(run.record.is_none(), "--record is not for --device gpu yet");
    ensure!(!arguments.profile, "--profile is not for --device gpu yet");
    let mut batch = begin(run, envs, options)?;
    let mut spent = Duration::ZERO;
    let mut steps = 0;
    while steps < run.steps && run.interrupt.signal().is_none() {
        let mut now = STEPS_A_CALL.min(run.steps - steps);
        if let Some(rows) = &run.controls {
            let row = Vec::from_iter(rows.row(steps).iter().map(|&u| u as f32));
            batch.write("ctrl", &row.repeat(envs))?;
            now = 1;
        }
        let start = Instant::now();
        batch.step(now)?;
        spent += start.elapsed();
        steps += now;
    }
    report(&batch, run, steps, spent.as_secs_f64())
}

/// A batch at the states that the arguments ask for.
fn begin(run: &Run, envs: usize, options: RigidOptions) -> Result<GpuBatch> {
    let device = GpuOptions {
        options,
        device: None,
    };
    let mut batch = GpuBatch::new(Arc::clone(&run.model), envs, device)?;
    let rows = BatchOptions {
        options,
        threads: Some(1),
        ..BatchOptions::default()
    };
    let mut starts = Batch::<f32>::with_options(Arc::clone(&run.model), envs, rows)?;
    run.starts.start_all(&mut starts)?;
    let state = &starts.state;
    for (name, rows) in [
        ("qpos", &state.qpos),
        ("qvel", &state.qvel),
        ("ctrl", &state.ctrl),
        ("mocap_pos", &state.mocap_pos),
        ("mocap_quat", &state.mocap_quat),
    ] {
        batch.write(name, rows.as_slice())?;
    }
    Ok(batch)
}

fn report(batch: &GpuBatch, run: &Run, steps: usize, seconds: f64) -> Result<GpuReport> {
    let envs = batch.count();
    let statuses = batch.statuses()?;
    let faults = statuses.iter().enumerate();
    let faults = faults.filter_map(|(env, fault)| fault.map(|fault| (env, fault.to_string())));
    let failures = Vec::from_iter(faults.map(|(env, reason)| Failure { env, reason }));
    let failed_envs = failures.len();
    let solves = batch.solves()?;
    let mean = |pick: fn(&GpuSolve) -> usize| {
        solves.iter().map(pick).sum::<usize>() as f64 / envs.max(1) as f64
    };
    Ok(GpuReport {
        status: match failed_envs {
            0 if steps < run.steps => "interrupted",
            0 => "ok",
            _ => "failed",
        },
        device: batch.device().to_string(),
        seconds,
        steps,
        envs,
        precision: 32,
        nv: run.model.nv,
        simulated_time: steps as f64 * run.model.params.timestep,
        steps_per_second: (steps * envs) as f64 / seconds.max(f64::MIN_POSITIVE),
        bytes_per_env: batch.bytes_per_env(),
        iterations_mean: mean(|solve| solve.iterations),
        contacts_mean: mean(|solve| solve.contacts),
        failed_envs,
        failures: failures.into_iter().take(NAMED_FAILURES).collect(),
        qpos: batch.read("qpos")?[..run.model.nq].to_vec(),
    })
}

impl fmt::Display for GpuReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{}: {} environments of {} dofs on {}",
            self.status, self.envs, self.nv, self.device
        )?;
        writeln!(
            f,
            "{} steps ({:.3} s simulated) in {:.3} s: {:.0} steps of environments a second",
            self.steps, self.simulated_time, self.seconds, self.steps_per_second
        )?;
        writeln!(
            f,
            "last solve: {:.2} iterations, {:.2} contacts on average; {} bytes an environment",
            self.iterations_mean, self.contacts_mean, self.bytes_per_env
        )?;
        for Failure { env, reason } in &self.failures {
            writeln!(f, "environment {env} failed: {reason}")?;
        }
        Ok(())
    }
}
