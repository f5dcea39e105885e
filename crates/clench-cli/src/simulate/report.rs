//! The report of a run, as text and as JSON.

use clench::collide::ShapeKind;
use clench::rigid::profile::{PairProfile, Profile};
use serde::Serialize;
use std::time::Duration;

/// The report of a finished run. Means and counts are over steps of environments.
#[derive(Serialize)]
pub(crate) struct Report {
    /// `ok`, `iteration_limit` (a solve stopped at its limit), `contact_overflow` (a step omitted contacts), `reset` (a
    /// step diverged and restarted), `interrupted`, `failed`, or `record_failed` (only writing the record failed).
    pub status: &'static str,
    /// The quality as one word, see [`verdict`](super::quality::verdict).
    pub quality: &'static str,
    /// The detected defects.
    pub warnings: Vec<String>,
    /// The wall time of stepping, s.
    pub seconds: f64,
    /// The number of steps of every environment that did not fail; if all failed, of the one that advanced furthest.
    pub steps: usize,
    pub envs: usize,
    pub threads: usize,
    /// The number of bits of a floating-point number.
    pub precision: usize,
    /// The instruction set.
    pub instructions: &'static str,
    pub nv: usize,
    /// The simulated time of these environments, s.
    pub simulated_time: f64,
    /// The number of environment steps per second of wall time.
    pub steps_per_second: f64,
    pub real_time_factor: f64,
    pub iterations_mean: f64,
    pub contacts_mean: f64,
    pub contacts_max: u64,
    pub gap_max: f64,
    pub penetration_max: f64,
    /// The number of steps whose solve stopped at the iteration limit.
    pub unconverged_steps: u64,
    /// The number of steps that found more contacts than the options allow, and continued. An environment of a batch
    /// fails instead.
    pub overflow_steps: u64,
    /// The number of steps that diverged and restarted from the initial state, with `--autoreset`.
    pub resets: u64,
    /// The change of the mechanical energy over the run, J, the largest of all environments; `None` unless the model
    /// conserves energy.
    pub energy_drift: Option<f64>,
    #[serde(flatten)]
    pub batch: Option<BatchReport>,
    /// The time of the stages, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<Vec<StageReport>>,
    /// The time of the narrow phase by pairs of kinds, with the profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pairs: Option<Vec<PairReport>>,
    /// The number of rows of the record, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_rows: Option<usize>,
    /// The reason of a failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Report {
    /// Sets the number of rows of the record, or the error of writing it, which has the lowest priority among failures.
    pub(crate) fn set_record(&mut self, recorded: anyhow::Result<Option<usize>>) {
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

/// The statistics of a batch.
#[derive(Serialize)]
pub(crate) struct BatchReport {
    /// The number of environments that a thread steps side by side.
    pub lanes: usize,
    pub bytes_per_env: usize,
    /// The additional memory of a thread, independent of the number of environments.
    pub scratch_bytes_per_thread: usize,
    /// The number of failed environments.
    pub failed_envs: usize,
    /// The first failed environments.
    pub failures: Vec<Failure>,
    pub divergence: DivergenceReport,
}

/// A failed environment.
#[derive(Serialize)]
pub(crate) struct Failure {
    pub env: usize,
    pub reason: String,
}

/// The divergence among environments side by side.
#[derive(Serialize)]
pub(crate) struct DivergenceReport {
    /// The share of active lanes in an iteration of the solver.
    pub live_share: f64,
    pub iterations_per_group: f64,
    pub slots_per_group: f64,
}

/// The time of a stage.
#[derive(Serialize)]
pub(crate) struct StageReport {
    pub stage: &'static str,
    /// The processor time per step and environment.
    pub microseconds: f64,
    /// The share of the time of all stages.
    pub percent: f64,
}

/// The pairs of geoms of two kinds; numbers are means over steps of environments.
#[derive(Serialize)]
pub(crate) struct PairReport {
    pub kinds: [String; 2],
    /// The number of pairs that the narrow phase tested: of environments side by side, in any of them.
    pub near: f64,
    /// The number of pairs with contacts.
    pub touching: f64,
    pub microseconds: f64,
}

/// Returns the pairs of a profile of `env_steps` environment steps, the most expensive first.
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

/// Returns the stages of a profile of `env_steps` environment steps. The remainder of the threads' `total` time,
/// between steps or idle, comes last.
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
