//! What a run of `simulate` reports.

use crate::record::worst_penetration;
use clench::Sim;
use clench::rigid::SimError;
use clench::solver::Status;
use serde::Serialize;
use std::fmt;

/// Accumulates over the steps of a run.
pub struct Summary {
    steps: usize,
    iterations: usize,
    contacts: usize,
    most_contacts: usize,
    worst_gap: f64,
    worst_penetration: f64,
    unconverged: usize,
    overflows: usize,
    constrained: bool,
    start_energy: f64,
    start_time: f64,
    failure: Option<String>,
}

/// The figures of a finished run.
#[derive(Serialize)]
pub struct Report {
    /// `ok`, `iteration_limit` (some solve stopped at its limit), `contact_overflow` (some step left contacts out) or
    /// `failed`.
    status: &'static str,
    /// Wall time of stepping alone, s.
    seconds: f64,
    steps: usize,
    envs: usize,
    nv: usize,
    simulated_time: f64,
    steps_per_second: f64,
    real_time_factor: f64,
    iterations_mean: f64,
    contacts_mean: f64,
    contacts_max: usize,
    gap_max: f64,
    penetration_max: f64,
    /// Steps whose solve stopped at the iteration limit.
    unconverged_steps: usize,
    /// Steps that found more contacts than the options allow.
    overflow_steps: usize,
    /// Change of the mechanical energy over the run, J; only where nothing adds or removes energy.
    energy_drift: Option<f64>,
    /// What went wrong, if something did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Summary {
    /// Starts at the simulation's present state.
    pub fn new(sim: &mut Sim) -> Result<Self, SimError> {
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
            start_time: sim.state.time,
            failure: None,
        })
    }

    /// Takes note of a step.
    pub fn after_step(&mut self, sim: &Sim) {
        let stats = sim.stats();
        let contacts = sim.contacts().len();
        self.steps += 1;
        self.iterations += stats.iterations;
        self.contacts += contacts;
        self.most_contacts = self.most_contacts.max(contacts);
        self.worst_gap = self.worst_gap.max(stats.gap);
        self.worst_penetration = self.worst_penetration.max(worst_penetration(sim));
        self.unconverged += usize::from(stats.status == Status::IterationLimit);
        self.overflows += usize::from(sim.contact_overflow());
        self.constrained |= sim.workspace().problem.nrow() > 0;
    }

    /// Takes note of the error that ended the run in step `step`.
    pub fn failed(&mut self, step: usize, error: &SimError) {
        self.failure = Some(format!("step {step}: {error}"));
    }

    /// The figures of the run, which took `seconds` of stepping.
    pub fn finish(self, sim: &mut Sim, seconds: f64) -> Report {
        let simulated_time = sim.state.time - self.start_time;
        let per_step = |total: usize| total as f64 / self.steps.max(1) as f64;
        let energy_drift = self.energy_drift(sim);
        Report {
            status: match (&self.failure, self.overflows, self.unconverged) {
                (Some(_), ..) => "failed",
                (None, 0, 0) => "ok",
                (None, 0, _) => "iteration_limit",
                _ => "contact_overflow",
            },
            seconds,
            steps: self.steps,
            envs: 1,
            nv: sim.model().nv,
            simulated_time,
            steps_per_second: self.steps as f64 / seconds.max(f64::MIN_POSITIVE),
            real_time_factor: simulated_time / seconds.max(f64::MIN_POSITIVE),
            iterations_mean: per_step(self.iterations),
            contacts_mean: per_step(self.contacts),
            contacts_max: self.most_contacts,
            gap_max: self.worst_gap,
            penetration_max: self.worst_penetration,
            unconverged_steps: self.unconverged,
            overflow_steps: self.overflows,
            energy_drift,
            failure: self.failure,
        }
    }

    fn energy_drift(&self, sim: &mut Sim) -> Option<f64> {
        let closed = !self.constrained && self.failure.is_none() && is_conservative(sim);
        let end = if closed { total_energy(sim).ok() } else { None };
        end.map(|energy| energy - self.start_energy)
    }
}

fn total_energy(sim: &mut Sim) -> Result<f64, SimError> {
    let energy = sim.energy()?;
    Ok(energy.potential + energy.kinetic)
}

/// Nothing in the model adds or removes energy while no constraint acts.
fn is_conservative(sim: &Sim) -> bool {
    let (model, state) = (sim.model(), &sim.state);
    let p = &model.params;
    let none = |values: &[f64]| values.iter().all(|&v| v == 0.0);
    none(&p.dof_damping)
        && none(&p.tendon_damping)
        && none(&p.body_gravcomp)
        && model.actuators.is_empty()
        && none(&state.qfrc_applied)
        && state.xfrc_applied.iter().all(|f| none(&f.to_array()))
        && p.density == 0.0
        && p.viscosity == 0.0
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, value: String| writeln!(f, "  {name:<20} {value}");
        line(
            "simulated time",
            format!("{:.4} s in {} steps", self.simulated_time, self.steps),
        )?;
        line(
            "speed",
            format!(
                "{:.0} steps/s, {:.1} × real time",
                self.steps_per_second, self.real_time_factor
            ),
        )?;
        line(
            "contacts",
            format!(
                "{:.1} a step, at most {}",
                self.contacts_mean, self.contacts_max
            ),
        )?;
        line(
            "solver",
            format!("{:.1} iterations a step", self.iterations_mean),
        )?;
        line(
            "worst duality gap",
            format!("{:.1e} (cost above the minimum)", self.gap_max),
        )?;
        line(
            "worst penetration",
            format!("{:.3} mm", 1e3 * self.penetration_max),
        )?;
        if let Some(drift) = self.energy_drift {
            line("energy drift", format!("{drift:.1e} J"))?;
        }
        if self.unconverged_steps > 0 {
            line(
                "not converged",
                format!(
                    "{} steps stopped at the iteration limit",
                    self.unconverged_steps
                ),
            )?;
        }
        if self.overflow_steps > 0 {
            line(
                "contacts left out",
                format!("in {} steps, by --max-contacts", self.overflow_steps),
            )?;
        }
        line("status", self.status.to_string())
    }
}
