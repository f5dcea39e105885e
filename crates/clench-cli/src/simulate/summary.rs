//! The statistics of the steps of one environment.

use super::quality::Verdict;
use super::report::Report;
use clench::math::Real;
use clench::rigid::batch::Quality;
use clench::rigid::{Precision, SimError};
use clench::{Model, Sim};

/// The statistics accumulated over a run.
pub(crate) struct Summary {
    iterations: usize,
    contacts: usize,
    overflows: u64,
    quality: Quality,
    start_energy: f64,
    failure: Option<String>,
}

impl Summary {
    /// Starts with the simulation's present state.
    pub(crate) fn new<T: Precision>(sim: &mut Sim<T>) -> Result<Self, SimError> {
        let start_energy = energy(sim)?.iter().sum();
        Ok(Summary {
            iterations: 0,
            contacts: 0,
            overflows: 0,
            quality: Quality::default(),
            start_energy,
            failure: None,
        })
    }

    /// Records a step.
    pub(crate) fn after_step<T: Precision>(&mut self, sim: &Sim<T>) {
        self.quality.add_step(sim);
        self.iterations += sim.stats().iterations;
        self.contacts += sim.contacts().len();
        self.overflows += u64::from(sim.contact_overflow());
    }

    /// Records the error that ended the run in step `step`.
    pub(crate) fn failed(&mut self, step: usize, error: &SimError) {
        self.failure = Some(format!("step {step}: {error}"));
    }

    /// Returns the quality statistics of the steps.
    pub(crate) fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Builds the report of a run with `seconds` of stepping.
    pub(crate) fn finish<T: Precision>(
        self,
        sim: &mut Sim<T>,
        seconds: f64,
        verdict: Verdict,
    ) -> Report {
        let steps = self.quality.steps;
        // Not by `time`, which is reset when the simulation restarts.
        let simulated_time = steps as f64 * sim.params().timestep.lane(0).to_f64();
        let per_step = |total: usize| total as f64 / steps.max(1) as f64;
        let energy_drift = self.energy_drift(sim);
        let quality = self.quality;
        Report {
            status: status(
                self.failure.is_some(),
                sim.resets(),
                self.overflows,
                quality.unconverged,
            ),
            quality: verdict.word,
            warnings: verdict.warnings,
            seconds,
            steps: steps as usize,
            envs: 1,
            threads: 1,
            precision: 8 * size_of::<T>(),
            instructions: "scalar",
            nv: sim.model().nv,
            simulated_time,
            steps_per_second: steps as f64 / seconds.max(f64::MIN_POSITIVE),
            real_time_factor: simulated_time / seconds.max(f64::MIN_POSITIVE),
            iterations_mean: per_step(self.iterations),
            contacts_mean: per_step(self.contacts),
            contacts_max: quality.contacts_max,
            gap_max: quality.gap_max,
            penetration_max: quality.penetration_max,
            unconverged_steps: quality.unconverged,
            overflow_steps: self.overflows,
            resets: sim.resets(),
            energy_drift,
            batch: None,
            profile: None,
            pairs: None,
            recorded_rows: None,
            failure: self.failure,
        }
    }

    fn energy_drift<T: Precision>(&self, sim: &mut Sim<T>) -> Option<f64> {
        let whole = self.failure.is_none() && sim.resets() == 0;
        let free = self.quality.constrained == 0 && whole;
        let end = (free && is_conservative(sim.model())).then(|| energy(sim).ok());
        let end: f64 = end.flatten()?.iter().sum();
        Some(end - self.start_energy)
    }
}

/// Returns the status of a run as one word.
pub(crate) fn status(failed: bool, resets: u64, overflows: u64, unconverged: u64) -> &'static str {
    match (failed, resets, overflows, unconverged) {
        (true, ..) => "failed",
        (false, 0, 0, 0) => "ok",
        (false, 0, 0, _) => "iteration_limit",
        (false, 0, ..) => "contact_overflow",
        _ => "reset",
    }
}

/// Returns the maximum penetration among the contacts, m; zero if there is none.
pub(crate) fn worst_penetration<T: Precision>(sim: &Sim<T>) -> f64 {
    (sim.contacts().iter()).fold(0.0, |worst, c| f64::max(worst, -c.dist.lane(0).to_f64()))
}

/// Returns true if the model conserves energy while no constraint acts and no forces are applied.
pub(crate) fn is_conservative(model: &Model) -> bool {
    let p = &model.params;
    let none = |values: &[f64]| values.iter().all(|&v| v == 0.0);
    none(&p.dof_damping)
        && none(p.dof_dampingpoly.as_flattened())
        && none(&p.tendon_damping)
        && none(p.tendon_dampingpoly.as_flattened())
        && none(&p.body_gravcomp)
        && model.actuators.is_empty()
        && p.density == 0.0
        && p.viscosity == 0.0
}

/// Returns the potential and kinetic energy of a simulation, J.
pub(crate) fn energy<T: Precision>(sim: &mut Sim<T>) -> Result<[f64; 2], SimError> {
    let energy = sim.energy()?;
    Ok([energy.potential, energy.kinetic].map(|x| x.to_f64()))
}
