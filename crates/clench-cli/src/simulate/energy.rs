//! Detection of spurious energy.
//!
//! Without actuators, a model's mechanical energy can only decrease: joints, contacts and fluids dissipate it. The work
//! of actuators is accumulated. An increase of energy beyond that work is compared with the errors of a sound run: a
//! share of the kinetic energy, by the integrator, and a small energy at rest, by soft constraints, such as geoms that
//! overlap initially.

use clench::Model;
use std::ops::Range;

/// The number of steps between energy checks.
pub(crate) const STEPS_BETWEEN_CHECKS: usize = 50;

/// The share of the kinetic energy attributed to integration errors.
const KINETIC_SHARE: f64 = 0.2;
/// The factor by which the energy may exceed the explained energy: the power of actuators is integrated step by step,
/// which is coarse.
const ALLOWANCE: f64 = 2.0;
/// Earth's gravity, m/s²; the scale of lifting work in any model, also in one without gravity.
const GRAVITY: f64 = 9.81;

/// The energy of the environments of a run.
pub(crate) struct EnergyAccount {
    timestep: f64,
    /// The work of lifting each body by its radius of gyration, J: a small energy for this model.
    little: f64,
    envs: Vec<Account>,
    worst: Option<Growth>,
}

struct Account {
    start: f64,
    supplied: f64,
    /// True if the energy once rose too far.
    grown: bool,
}

/// The largest spurious energy.
#[derive(Clone, Copy)]
pub(crate) struct Growth {
    pub env: usize,
    /// The increase of the mechanical energy, J.
    pub growth: f64,
    /// The work of the actuators, J.
    pub supplied: f64,
}

impl EnergyAccount {
    /// Opens an account of environments with these initial potential and kinetic energies, J. Returns `None` if sources
    /// other than actuators may supply energy: mocap bodies, gravity compensation, wind.
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
            // A radius of gyration r satisfies m r² = tr(I) / 2.
            GRAVITY * (0.5 * mass * trace).sqrt()
        };
        Some(EnergyAccount {
            timestep: p.timestep,
            little: bodies.map(lift).sum(),
            envs: start.into_iter().map(account).collect(),
            worst: None,
        })
    }

    /// Adds the actuator power, W, of an environment during a step.
    pub(crate) fn supply(&mut self, env: usize, power: f64) {
        self.envs[env].supplied += self.timestep * power;
    }

    /// Compares the potential and kinetic energy, J, of an environment with the supplied energy.
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

    /// Returns the number of environments that had spurious energy, and its maximum.
    pub(crate) fn grown(&self) -> Option<(usize, Growth)> {
        let count = self.envs.iter().filter(|account| account.grown).count();
        self.worst.map(|worst| (count, worst))
    }
}

/// Returns true if only actuators supply energy to the model.
fn is_closed(model: &Model) -> bool {
    let p = &model.params;
    let no_wind = p.wind.to_array().iter().all(|&v| v == 0.0);
    model.nmocap == 0 && p.body_gravcomp.iter().all(|&g| g == 0.0) && no_wind
}

/// Returns the next range of steps to take at once: up to the next step that is recorded or checked, or the end of the
/// run.
pub(crate) fn next_steps(
    done: usize,
    steps: usize,
    every: Option<usize>,
    max_steps: usize,
) -> Range<usize> {
    let multiple = |of: usize| (done / of + 1).saturating_mul(of);
    let mut end = steps
        .min(done.saturating_add(max_steps))
        .min(multiple(STEPS_BETWEEN_CHECKS));
    if let Some(every) = every {
        end = end.min(multiple(every));
    }
    done..end
}
