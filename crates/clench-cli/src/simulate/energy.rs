//! Energy that comes from nowhere.
//!
//! Without actuators, a model's mechanical energy can only fall: joints, contacts and fluids take from it. What actuators put in
//! is added up, and energy that rises by more than that is judged against what errors and the softness of constraints bring
//! about in a sound run: some of the kinetic energy, by the integrator, and a little at rest, as where geoms begin inside each other.

use clench::Model;
use std::ops::Range;

/// Steps between two comparisons of the energy with what was supplied.
pub(crate) const STEPS_BETWEEN_CHECKS: usize = 50;

/// The share of the kinetic energy that an integrator may get wrong.
const KINETIC_SHARE: f64 = 0.2;
/// How often the energy that has an explanation may come again without one: the power of actuators is added up step by step,
/// which is coarse.
const ALLOWANCE: f64 = 2.0;
/// Earth's gravity, m/s²: what lifting costs in any model, also in one without gravity.
const GRAVITY: f64 = 9.81;

/// The energy of the environments of a run.
pub(crate) struct EnergyAccount {
    timestep: f64,
    /// What lifting each body by its own radius of gyration would cost, J: what is little for this model.
    little: f64,
    envs: Vec<Account>,
    worst: Option<Growth>,
}

struct Account {
    start: f64,
    supplied: f64,
    /// Whether it once rose too far.
    grown: bool,
}

/// The largest energy that came from nowhere.
#[derive(Clone, Copy)]
pub(crate) struct Growth {
    pub env: usize,
    /// By how much the mechanical energy rose, J.
    pub growth: f64,
    /// What actuators had put in, J.
    pub supplied: f64,
}

impl EnergyAccount {
    /// An account of environments that start with these energies, potential and kinetic, in J. None for a model to which others
    /// than actuators may give energy: mocap bodies, gravity compensation, wind.
    pub(crate) fn open(model: &Model, start: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        if !is_closed(model) {
            return None;
        }
        let account = |energy: [f64; 2]| Account {
            start: energy[0] + energy[1],
            supplied: 0.0,
            grown: false,
        };
        let p = &model.params;
        let bodies = p.body_mass.iter().zip(&p.body_inertia).skip(1);
        let lift = |(&mass, inertia): (&f64, &clench::math::Vec3<f64>)| {
            let trace: f64 = inertia.to_array().iter().sum();
            // A radius of gyration r has m r² = tr(I) / 2.
            GRAVITY * (0.5 * mass * trace).sqrt()
        };
        Some(EnergyAccount {
            timestep: p.timestep,
            little: bodies.map(lift).sum(),
            envs: start.into_iter().map(account).collect(),
            worst: None,
        })
    }

    /// Takes in the power, W, that the actuators of an environment put in during a step.
    pub(crate) fn supply(&mut self, env: usize, power: f64) {
        self.envs[env].supplied += self.timestep * power;
    }

    /// Compares the potential and kinetic energy, J, of an environment with what was supplied to it.
    pub(crate) fn check(&mut self, env: usize, [potential, kinetic]: [f64; 2]) {
        let account = &mut self.envs[env];
        let (growth, supplied) = (potential + kinetic - account.start, account.supplied);
        let explained = ALLOWANCE * (self.little + supplied) + KINETIC_SHARE * kinetic;
        if growth > explained {
            account.grown = true;
            if self.worst.is_none_or(|worst| growth > worst.growth) {
                self.worst = Some(Growth {
                    env,
                    growth,
                    supplied,
                });
            }
        }
    }

    /// How many environments once had energy from nowhere, and the most of it.
    pub(crate) fn grown(&self) -> Option<(usize, Growth)> {
        let count = self.envs.iter().filter(|account| account.grown).count();
        self.worst.map(|worst| (count, worst))
    }
}

/// Whether nobody but actuators gives energy to a model.
fn is_closed(model: &Model) -> bool {
    let p = &model.params;
    let still = p.wind.to_array().iter().all(|&v| v == 0.0);
    model.nmocap == 0 && p.body_gravcomp.iter().all(|&g| g == 0.0) && still
}

/// The next range of steps to take at once: up to the next that is recorded, is looked at, or ends the run.
pub(crate) fn next_steps(
    done: usize,
    steps: usize,
    every: Option<usize>,
    most: usize,
) -> Range<usize> {
    let multiple = |of: usize| (done / of + 1).saturating_mul(of);
    let mut end = steps
        .min(done.saturating_add(most))
        .min(multiple(STEPS_BETWEEN_CHECKS));
    if let Some(every) = every {
        end = end.min(multiple(every));
    }
    done..end
}
