//! The memory of the integrators.

use super::coriolis::Coriolis;
use super::plastic::has_yielding_tendons;
use crate::model::{Integrator, Model};
use clench_math::{Mask, Real};
use clench_solver::{TreeFactor, TreeLu, TreeMatrix};

/// Memory of the integrators.
#[derive(Clone, Debug)]
pub struct Integration<T: Real> {
    /// M − h ∂τ/∂v.
    pub matrix: TreeMatrix<T>,
    /// Its factor.
    pub factor: TreeFactor<T>,
    /// The same with its non-symmetric part, then its factors; empty except for [`Integrator::Implicit`].
    pub full: TreeLu<T>,
    /// The scratch memory for derivatives of bias forces, likewise.
    pub coriolis: Coriolis<T>,
    /// The acceleration that advances the velocity (nv).
    pub qacc: Vec<T>,
    /// Runge–Kutta: the time of the current stage after the state's time, s; else zero.
    pub offset: T,
    /// Runge–Kutta: the state at the start of the step.
    pub start: Rates<T>,
    /// Runge–Kutta: the velocities of actuators (nout) at the start of the step.
    pub actuator_velocity: Vec<T>,
    /// The lanes with implicit damping and a damped dof, and the [version](crate::fixed::FixedPoses::version) of the
    /// parameters for which they were found.
    pub damped: (T::Mask, u64),
    /// Runge–Kutta: tendon lengths and gradients at the start of the step; empty if no tendon's spring yields.
    pub tendons: [Vec<T>; 2],
    /// Runge–Kutta: the rates of the current stage.
    pub stage: Rates<T>,
    /// Runge–Kutta: the weighted mean of all stages' rates.
    pub mean: Rates<T>,
}

/// Positions, velocities and activations, or their rates of change.
#[derive(Clone, Debug, Default)]
pub struct Rates<T> {
    /// Positions (nq), or their rates (nv).
    pub position: Vec<T>,
    /// Velocities, or accelerations (nv).
    pub velocity: Vec<T>,
    /// Activations, or their rates (na).
    pub activation: Vec<T>,
}

impl<T: Real> Rates<T> {
    fn new(model: &Model, npos: usize) -> Self {
        Rates {
            position: vec![T::ZERO; npos],
            velocity: vec![T::ZERO; model.nv],
            activation: vec![T::ZERO; model.na],
        }
    }
}

impl<T: Real> Integration<T> {
    /// Allocates memory for the integrators of a model.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub fn new(model: &Model) -> Self {
        let (full, coriolis) = match model.integrator {
            Integrator::Implicit => (TreeLu::zeros(&model.tree), Coriolis::new(model)),
            Integrator::Euler
            | Integrator::ImplicitFast
            | Integrator::Rk4
            | Integrator::Discrete => Default::default(),
        };
        Integration {
            matrix: TreeMatrix::zeros(&model.tree),
            factor: TreeFactor::zeros(&model.tree),
            full,
            coriolis,
            qacc: vec![T::ZERO; model.nv],
            offset: T::ZERO,
            start: Rates::new(model, model.nq),
            actuator_velocity: vec![T::ZERO; model.nout()],
            damped: (T::Mask::splat(false), 0),
            tendons: match has_yielding_tendons(model) || model.max_stick_pairs.is_some() {
                true => [model.tendons.len(), model.tendon_dofs.len()].map(|n| vec![T::ZERO; n]),
                false => Default::default(),
            },
            stage: Rates::new(model, model.nv),
            mean: Rates::new(model, model.nv),
        }
    }
}
