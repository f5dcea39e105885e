//! What is noted of the steps of one environment.

use super::report::Report;
use clench::rigid::{Precision, SimError};
use clench::solver::Status;
use clench::{Model, Sim};

/// Accumulates over the steps of a run.
pub struct Summary {
    steps: usize,
    iterations: usize,
    contacts: usize,
    most_contacts: usize,
    worst_gap: f64,
    worst_penetration: f64,
    unconverged: u64,
    overflows: u64,
    constrained: bool,
    start_energy: f64,
    start_time: f64,
    failure: Option<String>,
}

impl Summary {
    /// Starts at the simulation's present state.
    pub fn new<T: Precision>(sim: &mut Sim<T>) -> Result<Self, SimError> {
        let start_energy = total_energy(sim)?;
        Ok(Summary {
            steps: 0,
            iterations: 0,
            contacts: 0,
            most_contacts: 0,
            worst_gap: 0.0,
            worst_penetration: 0.0,
            unconverged: 0,
            overflows: 0,
            constrained: false,
            start_energy,
            start_time: sim.state.time.to_f64(),
            failure: None,
        })
    }

    /// Takes note of a step.
    pub fn after_step<T: Precision>(&mut self, sim: &Sim<T>) {
        let stats = sim.stats();
        let contacts = sim.contacts().len();
        self.steps += 1;
        self.iterations += stats.iterations;
        self.contacts += contacts;
        self.most_contacts = self.most_contacts.max(contacts);
        self.worst_gap = self.worst_gap.max(stats.gap);
        self.worst_penetration = self.worst_penetration.max(worst_penetration(sim));
        self.unconverged += u64::from(stats.status == Status::IterationLimit);
        self.overflows += u64::from(sim.contact_overflow());
        self.constrained |= sim.workspace().problem.nrow() > 0;
    }

    /// Takes note of the error that ended the run in step `step`.
    pub fn failed(&mut self, step: usize, error: &SimError) {
        self.failure = Some(format!("step {step}: {error}"));
    }

    /// The figures of the run, which took `seconds` of stepping.
    pub fn finish<T: Precision>(self, sim: &mut Sim<T>, seconds: f64) -> Report {
        let simulated_time = sim.state.time.to_f64() - self.start_time;
        let per_step = |total: usize| total as f64 / self.steps.max(1) as f64;
        let energy_drift = self.energy_drift(sim);
        Report {
            status: status(self.failure.is_some(), self.overflows, self.unconverged),
            seconds,
            steps: self.steps,
            envs: 1,
            threads: 1,
            precision: 8 * size_of::<T>(),
            instructions: "scalar",
            nv: sim.model().nv,
            simulated_time,
            steps_per_second: self.steps as f64 / seconds.max(f64::MIN_POSITIVE),
            real_time_factor: simulated_time / seconds.max(f64::MIN_POSITIVE),
            iterations_mean: per_step(self.iterations),
            contacts_mean: per_step(self.contacts),
            contacts_max: self.most_contacts as u64,
            gap_max: self.worst_gap,
            penetration_max: self.worst_penetration,
            unconverged_steps: self.unconverged,
            overflow_steps: self.overflows,
            energy_drift,
            batch: None,
            profile: None,
            failure: self.failure,
        }
    }

    fn energy_drift<T: Precision>(&self, sim: &mut Sim<T>) -> Option<f64> {
        let closed = !self.constrained && self.failure.is_none() && is_conservative(sim.model());
        let end = if closed { total_energy(sim).ok() } else { None };
        end.map(|energy| energy - self.start_energy)
    }
}

/// A run's status in a word.
pub fn status(failed: bool, overflows: u64, unconverged: u64) -> &'static str {
    match (failed, overflows, unconverged) {
        (true, ..) => "failed",
        (false, 0, 0) => "ok",
        (false, 0, _) => "iteration_limit",
        _ => "contact_overflow",
    }
}

/// The deepest penetration among the contacts, m; zero where nothing penetrates.
pub fn worst_penetration<T: Precision>(sim: &Sim<T>) -> f64 {
    (sim.contacts().iter()).fold(0.0, |worst, c| f64::max(worst, -c.dist.to_f64()))
}

/// Nothing in the model adds or removes energy while no constraint acts and nobody applies forces.
pub fn is_conservative(model: &Model) -> bool {
    let p = &model.params;
    let none = |values: &[f64]| values.iter().all(|&v| v == 0.0);
    none(&p.dof_damping)
        && none(&p.tendon_damping)
        && none(&p.body_gravcomp)
        && model.actuators.is_empty()
        && p.density == 0.0
        && p.viscosity == 0.0
}

fn total_energy<T: Precision>(sim: &mut Sim<T>) -> Result<f64, SimError> {
    let energy = sim.energy()?;
    Ok((energy.potential + energy.kinetic).to_f64())
}
