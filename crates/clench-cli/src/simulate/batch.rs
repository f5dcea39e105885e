//! A run of a batch of environments.

use super::arguments::Arguments;
use super::energy::{EnergyAccount, STEPS_BETWEEN_CHECKS};
use super::quality::{Verdict, verdict};
use super::record::BATCH_OUTPUTS;
use super::report::{BatchReport, DivergenceReport, Failure, Report, pairs, stages};
use super::rollout::{Rollout, RunResult};
use super::run::Run;
use super::start::widen;
use super::summary::{is_conservative, status};
use crate::allocator::ALLOCATOR;
use crate::message::print_message;
use anyhow::Result;
use clench::math::{Instructions, Scalar};
use clench::rigid::batch::Recording;
use clench::rigid::{EnvStatus, Precision};
use clench::{Batch, RigidOptions};
use std::time::{Duration, Instant};

/// The number of environment steps per call, after which signals are checked: about one second of work.
const ENV_STEPS_A_CALL: usize = 1 << 19;
/// The minimum number of steps per call: environments are regrouped only between calls.
const MIN_STEPS_A_CALL: usize = 8;
/// The maximum number of failed environments that a report lists.
const NAMED_FAILURES: usize = 10;

fn name(instructions: Instructions) -> &'static str {
    match instructions {
        Instructions::Scalar => "scalar",
        Instructions::Portable => "portable",
        Instructions::Neon => "neon",
        Instructions::Avx2 => "avx2",
        Instructions::Avx512 => "avx512",
    }
}

/// Steps a batch of environments.
pub(crate) fn run<S: Precision>(
    arguments: &Arguments,
    run: &Run,
    envs: u32,
    options: RigidOptions,
) -> Result<Report> {
    if let Some(advice) = Instructions::advice() {
        print_message(format_args!("note: {advice}"));
    }
    let mut heap = Heap::default();
    let options = arguments.batch.options(options);
    let mut batch =
        heap.measure(|| Batch::<S>::of_models_in_turn(&run.models, envs as usize, options))?;
    run.starts.start_all(&mut batch)?;
    let times = widen(batch.state.time.as_slice());
    let energies = energies(&mut batch, &mut heap)?;
    // The energy of several models is not judged.
    let single_model = run.models.len() == 1;
    let mut account = match single_model {
        true => EnergyAccount::open(&run.model, energies.iter().copied()),
        false => None,
    };
    let max_steps = (ENV_STEPS_A_CALL / batch.count()).max(MIN_STEPS_A_CALL);
    let rollout = Rollout::new(run, batch.count(), max_steps)?;
    let records = rollout.records();
    let traced: &[&str] = match &account {
        Some(_) if run.model.nu() > 0 => &["actuator_power"],
        _ => &[],
    };
    batch.clear_figures();
    let mut spent = Duration::ZERO;
    let RunResult {
        steps,
        recorded_rows,
    } = rollout.run(&mut batch, |batch, range, controls| {
        let is_checked = range.end.is_multiple_of(STEPS_BETWEEN_CHECKS) || range.end == run.steps;
        let recorded = BATCH_OUTPUTS.into_iter().filter(|_| records);
        let energy = (account.is_some() && is_checked).then_some("energy");
        let outputs = Vec::from_iter(recorded.chain(energy));
        heap.measure(|| batch.record(&outputs))?;
        // Queries between calls are not counted.
        batch.run_clocks(arguments.profile);
        let begin = Instant::now();
        let recording = heap.measure(|| batch.rollout(range.len(), controls, traced))?;
        spent += begin.elapsed();
        batch.run_clocks(false);
        if let Some(account) = &mut account {
            watch(account, &recording, batch);
        }
        Ok(recording.summary.running)
    })?;
    let verdict = verdict(batch.model(), &batch.quality(), account.as_ref());
    let mut report = report(&batch, done(&batch, &times, steps), spent, &heap, verdict);
    let whole = report.failure.is_none() && report.resets == 0;
    report.set_record(recorded_rows);
    let free = whole && batch.quality().constrained == 0;
    if free && single_model && is_conservative(&run.model) {
        report.energy_drift = drift(&energies, &self::energies(&mut batch, &mut heap)?);
    }
    let env_steps = batch.divergence().env_steps;
    let total = spent * batch.threads() as u32;
    let profile = arguments.profile.then(|| batch.profile());
    report.pairs = profile.as_ref().map(|profile| pairs(profile, env_steps));
    report.profile = profile.map(|profile| stages(&profile, total, env_steps));
    Ok(report)
}

/// Adds the steps of a call to the energy account, and checks the resulting energies if they were recorded.
fn watch<S: Precision>(account: &mut EnergyAccount, recording: &Recording<S>, batch: &Batch<S>) {
    if let Some(powers) = recording.get("actuator_power") {
        for (env, powers) in powers.iter().enumerate() {
            // Steps that were not taken are NaN.
            let done = powers.iter().map(|x| x.to_f64()).filter(|x| !x.is_nan());
            account.supply(env, done.sum());
        }
    }
    if let Some(energies) = batch.output("energy") {
        let running = |&(env, _): &(usize, _)| batch.status(env) == EnvStatus::Running;
        for (env, energy) in energies.iter().enumerate().filter(running) {
            account.check(env, [energy[0], energy[1]].map(|x| x.to_f64()));
        }
    }
}

/// Returns the number of steps, at most `steps`, and the simulated time, s, of the environment that advanced furthest;
/// `start` are the initial times.
fn done<S: Precision>(batch: &Batch<S>, start: &[f64], steps: usize) -> (usize, f64) {
    let timestep = batch.model().params.timestep;
    if batch.statuses().contains(&EnvStatus::Running) {
        return (steps, steps as f64 * timestep);
    }
    let ends = batch.state.time.as_slice().iter().map(|x| x.to_f64());
    let furthest = ends
        .zip(start)
        .map(|(end, start)| end - start)
        .fold(0.0, f64::max);
    ((furthest / timestep).round() as usize, furthest)
}

/// The heap memory of a batch, bytes.
#[derive(Default)]
struct Heap {
    allocated: usize,
    freed: usize,
}

impl Heap {
    /// Runs `work` and records the memory that it allocated or freed.
    fn measure<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let before = ALLOCATOR.allocated();
        let result = work();
        let after = ALLOCATOR.allocated();
        self.allocated += after.saturating_sub(before);
        self.freed += before.saturating_sub(after);
        result
    }
}

/// Returns the potential and kinetic energy of each environment, J.
fn energies<S: Precision>(batch: &mut Batch<S>, heap: &mut Heap) -> Result<Vec<[f64; 2]>> {
    heap.measure(|| batch.record(&["energy"]))?;
    let energies = batch.output("energy").map(|rows| {
        let parts = |parts: &[S]| [parts[0], parts[1]].map(|x| x.to_f64());
        rows.iter().map(parts).collect()
    });
    heap.measure(|| batch.record(&[]))?;
    Ok(energies.unwrap_or_default())
}

/// Returns the change of energy with the largest magnitude over all environments.
fn drift(start: &[[f64; 2]], end: &[[f64; 2]]) -> Option<f64> {
    let total = |energies: &[f64; 2]| energies.iter().sum::<f64>();
    let changes = end
        .iter()
        .zip(start)
        .map(|(end, start)| total(end) - total(start));
    changes.max_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// Builds the report of a run.
fn report<S: Precision>(
    batch: &Batch<S>,
    (steps, simulated_time): (usize, f64),
    spent: Duration,
    heap: &Heap,
    verdict: Verdict,
) -> Report {
    let (divergence, quality) = (batch.divergence(), batch.quality());
    let seconds = spent.as_secs_f64();
    let rate = |amount: f64| amount / seconds.max(f64::MIN_POSITIVE);
    let timestep = batch.model().params.timestep;
    let failures = failures(batch);
    let resets = batch.resets().iter().sum();
    let rows = batch.count() * batch.bytes_per_env();
    let scratch = heap.allocated.saturating_sub(heap.freed + rows);
    Report {
        status: status(!failures.is_empty(), resets, 0, quality.unconverged),
        quality: verdict.word,
        warnings: verdict.warnings,
        seconds,
        steps,
        envs: batch.count(),
        threads: batch.threads(),
        precision: 8 * size_of::<S>(),
        instructions: batch.options().instructions.map_or("scalar", name),
        nv: batch.model().nv,
        simulated_time,
        steps_per_second: rate(divergence.env_steps as f64),
        real_time_factor: rate(divergence.env_steps as f64 * timestep),
        iterations_mean: divergence.iterations_per_env(),
        contacts_mean: divergence.contacts_per_env(),
        contacts_max: quality.contacts_max,
        gap_max: quality.gap_max,
        penetration_max: quality.penetration_max,
        unconverged_steps: quality.unconverged,
        overflow_steps: 0,
        resets,
        energy_drift: None,
        recorded_rows: None,
        failure: failures.first().map(|first| {
            let (failed, count) = (failures.len(), batch.count());
            let Failure { env, reason } = first;
            format!("{failed} of {count} environments failed; environment {env}: {reason}")
        }),
        batch: Some(BatchReport {
            lanes: batch.lanes(),
            bytes_per_env: batch.bytes_per_env(),
            scratch_bytes_per_thread: scratch / batch.threads(),
            failed_envs: failures.len(),
            failures: failures.into_iter().take(NAMED_FAILURES).collect(),
            divergence: DivergenceReport {
                live_share: divergence.live_share(),
                iterations_per_group: divergence.iterations_per_group(),
                slots_per_group: divergence.slots_per_group(),
            },
        }),
        profile: None,
        pairs: None,
    }
}

/// Returns the failed environments.
fn failures<S: Precision>(batch: &Batch<S>) -> Vec<Failure> {
    let failed = |(env, status): (usize, &EnvStatus)| match status {
        EnvStatus::Running => None,
        EnvStatus::Failed(fault) => Some(Failure {
            env,
            reason: fault.to_string(),
        }),
    };
    batch
        .statuses()
        .iter()
        .enumerate()
        .filter_map(failed)
        .collect()
}
