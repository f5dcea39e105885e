//! A run of a batch on a GPU.

use super::arguments::Arguments;
use super::record::BATCH_OUTPUTS;
use super::report::Failure;
use super::rollout::Rollout;
use super::run::Run;
use anyhow::{Result, bail, ensure};
use clench::{Batch, BatchOptions, EnvStatus, RigidOptions};
use clench_gpu::{GpuError, GpuReal};
use serde::Serialize;
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The number of steps per call, after which signals are checked.
const STEPS_A_CALL: usize = 64;
/// The maximum number of failed environments that a report lists.
const NAMED_FAILURES: usize = 10;

/// The report of a finished run.
#[derive(Serialize)]
pub(crate) struct GpuReport {
    /// `ok`, `interrupted`, or `failed` if an environment failed.
    status: &'static str,
    device: String,
    /// The wall time of stepping, s.
    seconds: f64,
    steps: usize,
    envs: usize,
    /// The number of bits of a floating-point number.
    precision: usize,
    nv: usize,
    simulated_time: f64,
    steps_per_second: f64,
    bytes_per_env: usize,
    /// The mean over environments, of the last solve.
    iterations_mean: f64,
    contacts_mean: f64,
    /// The number of rows of the record, if there is one.
    recorded_rows: Option<usize>,
    failed_envs: usize,
    /// The first failed environments.
    failures: Vec<Failure>,
    /// The final positions of the first environment.
    qpos: Vec<f64>,
}

impl GpuReport {
    /// Returns true if an environment failed.
    pub(crate) fn failed(&self) -> bool {
        self.failed_envs > 0
    }
}

/// Lists the devices in the order of preference.
///
/// # Errors
/// Returns an error if there is none.
pub(crate) fn list() -> Result<()> {
    let all = clench_gpu::devices();
    ensure!(!all.is_empty(), GpuError::NoDevice);
    all.iter().for_each(|device| println!("{device}"));
    Ok(())
}

/// Steps a batch on the first device, in the precision `S`.
///
/// # Errors
/// Returns an error if there is no device, or it does not support the model or an argument.
pub(super) fn run<S: GpuReal>(
    arguments: &Arguments,
    run: &Run,
    envs: usize,
    options: RigidOptions,
) -> Result<GpuReport> {
    if let Some(flag) = arguments.batch.of_processor() {
        bail!("{flag} is not for --device gpu");
    }
    ensure!(!arguments.profile, "--profile is not for --device gpu yet");
    let rows = BatchOptions {
        options,
        threads: Some(1),
        ..BatchOptions::default()
    };
    let mut batch = clench_gpu::batch::<S>(Arc::clone(&run.model), envs, rows, None)?;
    run.starts.start_all(&mut batch)?;
    batch.record(&BATCH_OUTPUTS)?;
    let rollout = Rollout::new(run, envs, STEPS_A_CALL)?;
    let mut spent = Duration::ZERO;
    let result = rollout.run(&mut batch, |batch, range, controls| {
        let begin = Instant::now();
        let recording = batch.rollout(range.len(), controls, &[])?;
        spent += begin.elapsed();
        Ok(recording.summary.running)
    })?;
    Ok(GpuReport {
        recorded_rows: result.recorded_rows?,
        ..report(&batch, run, result.steps, spent.as_secs_f64())
    })
}

fn report<S: GpuReal>(batch: &Batch<S>, run: &Run, steps: usize, seconds: f64) -> GpuReport {
    let envs = batch.count();
    let faults = batch.statuses().iter().enumerate();
    let failures = faults.filter_map(|(env, status)| match status {
        EnvStatus::Running => None,
        EnvStatus::Failed(fault) => Some((env, fault.to_string())),
    });
    let failures = Vec::from_iter(failures.map(|(env, reason)| Failure { env, reason }));
    let failed_envs = failures.len();
    let mean = |name: &str| {
        let rows = batch.output(name).map_or(&[][..], |rows| rows.as_slice());
        rows.iter().map(|x| x.to_f64()).sum::<f64>() / envs.max(1) as f64
    };
    GpuReport {
        status: match failed_envs {
            0 if steps < run.steps => "interrupted",
            0 => "ok",
            _ => "failed",
        },
        device: batch.device().unwrap_or_default(),
        seconds,
        steps,
        envs,
        precision: 8 * size_of::<S>(),
        nv: run.model.nv,
        simulated_time: steps as f64 * run.model.params.timestep,
        steps_per_second: (steps * envs) as f64 / seconds.max(f64::MIN_POSITIVE),
        bytes_per_env: batch.bytes_per_env(),
        iterations_mean: mean("solver_iterations"),
        contacts_mean: mean("contact_count"),
        recorded_rows: None,
        failed_envs,
        failures: failures.into_iter().take(NAMED_FAILURES).collect(),
        qpos: batch.state.qpos.row(0).iter().map(|x| x.to_f64()).collect(),
    }
}

impl fmt::Display for GpuReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{}: {} environments of {} dofs on {}, {} bit",
            self.status, self.envs, self.nv, self.device, self.precision
        )?;
        writeln!(
            f,
            "{} steps ({:.3} s simulated) in {:.3} s: {:.0} environment steps per second",
            self.steps, self.simulated_time, self.seconds, self.steps_per_second
        )?;
        writeln!(
            f,
            "last solve: {:.2} iterations, {:.2} contacts on average; {} bytes per environment",
            self.iterations_mean, self.contacts_mean, self.bytes_per_env
        )?;
        if let Some(rows) = self.recorded_rows {
            writeln!(f, "{rows} rows are recorded")?;
        }
        for Failure { env, reason } in &self.failures {
            writeln!(f, "environment {env} failed: {reason}")?;
        }
        Ok(())
    }
}
