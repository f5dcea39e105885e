//! The figures of a run, as text and as JSON.

use clench::collide::ShapeKind;
use clench::rigid::profile::{PairProfile, Profile};
use serde::Serialize;
use std::time::Duration;

/// The figures of a finished run. Means and counts are over steps of environments.
#[derive(Serialize)]
pub(crate) struct Report {
    /// `ok`, `iteration_limit` (some solve stopped at its limit), `contact_overflow` (some step left contacts out), `reset`
    /// (some step diverged and started over), `interrupted`, `failed`, or `record_failed` (all went well but the record).
    pub status: &'static str,
    /// What the run is worth in a word, see [`verdict`](super::quality::verdict).
    pub quality: &'static str,
    /// What can be said against it.
    pub warnings: Vec<String>,
    /// Wall time of stepping alone, s.
    pub seconds: f64,
    /// Steps that every environment that did not fail has done; if all failed, those of the one that came furthest.
    pub steps: usize,
    pub envs: usize,
    pub threads: usize,
    /// Bits of a number.
    pub precision: usize,
    /// How environments lie side by side.
    pub instructions: &'static str,
    pub nv: usize,
    /// Seconds that these environments went through.
    pub simulated_time: f64,
    /// Steps of environments in a second of wall time.
    pub steps_per_second: f64,
    pub real_time_factor: f64,
    pub iterations_mean: f64,
    pub contacts_mean: f64,
    pub contacts_max: u64,
    pub gap_max: f64,
    pub penetration_max: f64,
    /// Steps whose solve stopped at the iteration limit.
    pub unconverged_steps: u64,
    /// Steps that found more contacts than the options allow, and went on. An environment of a batch fails instead.
    pub overflow_steps: u64,
    /// Steps that started over from the initial state because the simulation diverged, with `--autoreset`.
    pub resets: u64,
    /// Change of the mechanical energy over the run, J, the largest of all environments; only where nothing adds or removes
    /// energy.
    pub energy_drift: Option<f64>,
    #[serde(flatten)]
    pub batch: Option<BatchReport>,
    /// Where the time went, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<Vec<StageReport>>,
    /// Where the narrow phase spends its time, with the profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pairs: Option<Vec<PairReport>>,
    /// Rows of the record, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_rows: Option<usize>,
    /// What went wrong, if something did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Report {
    /// Takes over how many rows a record has, if there is one and it could be written; that it could not is the least of failures.
    pub(crate) fn take_record(&mut self, recorded: anyhow::Result<Option<usize>>) {
        match recorded {
            Ok(rows) => self.recorded_rows = rows,
            Err(error) if self.failure.is_none() => {
                self.status = "record_failed";
                self.failure = Some(format!("{error:#}"));
            }
            Err(error) => self.warnings.push(format!("{error:#}")),
        }
    }
}

/// What only a batch has.
#[derive(Serialize)]
pub(crate) struct BatchReport {
    /// Environments that a thread steps side by side.
    pub lanes: usize,
    pub bytes_per_env: usize,
    /// What a thread needs beside, whatever the number of environments.
    pub scratch_bytes_per_thread: usize,
    /// How many environments failed.
    pub failed_envs: usize,
    /// The first of them.
    pub failures: Vec<Failure>,
    pub divergence: DivergenceReport,
}

/// An environment that could not go on.
#[derive(Serialize)]
pub(crate) struct Failure {
    pub env: usize,
    pub reason: String,
}

/// How unlike environments side by side were.
#[derive(Serialize)]
pub(crate) struct DivergenceReport {
    /// The share of lanes at work in an iteration of the solver.
    pub live_share: f64,
    pub iterations_per_group: f64,
    pub slots_per_group: f64,
}

/// The time of a stage.
#[derive(Serialize)]
pub(crate) struct StageReport {
    pub stage: &'static str,
    /// Processor time a step and environment.
    pub microseconds: f64,
    /// Of the time of all stages.
    pub percent: f64,
}

/// Pairs of geoms of two kinds; numbers are means over steps of environments.
#[derive(Serialize)]
pub(crate) struct PairReport {
    pub kinds: [String; 2],
    /// Pairs that were near enough to be looked at: of environments side by side, in any of them.
    pub near: f64,
    /// Pairs with contacts.
    pub touching: f64,
    pub microseconds: f64,
}

/// The pairs of a profile of so many steps of environments, the most expensive first.
pub(crate) fn pairs(profile: &Profile, env_steps: u64) -> Vec<PairReport> {
    let steps = env_steps.max(1) as f64;
    let kind = |kind: ShapeKind| format!("{kind:?}").to_lowercase();
    let report = |pair: &PairProfile| PairReport {
        kinds: pair.kinds.map(kind),
        near: pair.near as f64 / steps,
        touching: pair.touching as f64 / steps,
        microseconds: 1e6 * pair.time.as_secs_f64() / steps,
    };
    let mut reports = Vec::from_iter(profile.pairs.iter().map(report));
    reports.sort_by(|a, b| b.microseconds.total_cmp(&a.microseconds));
    reports
}

/// The stages of a profile of so many steps of environments. The rest of what threads spent, `total`, comes last:
/// between steps, or idle.
pub(crate) fn stages(profile: &Profile, total: Duration, env_steps: u64) -> Vec<StageReport> {
    let elsewhere = total.saturating_sub(profile.total());
    let whole = (profile.total() + elsewhere).as_secs_f64();
    let all = profile.stages.iter().copied();
    all.chain([("elsewhere", elsewhere)])
        .map(|(stage, time)| StageReport {
            stage,
            microseconds: 1e6 * time.as_secs_f64() / env_steps.max(1) as f64,
            percent: 100.0 * time.as_secs_f64() / whole.max(f64::MIN_POSITIVE),
        })
        .collect()
}
