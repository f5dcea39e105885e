//! Inverse dynamics: computes the forces that cause a given acceleration.
//!
//! The constraint forces follow from the acceleration without iteration: f = −∇s(J a − aref), block by block (Todorov
//! 2014, "Convex and analytically-invertible dynamics with contacts and constraints"). The remainder of the equation of
//! motion
//!
//! ```text
//! M a + bias = passive + Jᵀ f + τ
//! ```
//!
//! is τ, the sum of actuator and applied forces. Forward dynamics with this τ compute the same acceleration.
//!
//! If forces are evaluated at the end of a step, the step does not advance the velocity by the acceleration a of
//! forward dynamics, but by a′ with M′ a′ = M a, where M′ = M − h ∂τ/∂v depends on the integrator. The acceleration a
//! is first computed from (v₁ − v₀)/h = a′. With the integrator `discrete` both are equal, and its metric replaces M.

use crate::constraint::assemble;
use crate::contact::detect;
use crate::context::StepContext;
use crate::dynamics::actuation::actuation;
use crate::dynamics::adhesion::adhesion;
use crate::dynamics::discrete::{add_metric_forces, apply_metric};
use crate::dynamics::euler::{damped_inertia, damped_lanes};
use crate::dynamics::implicit::{add_gyroscopic_products, full_inertia, symmetric_inertia};
use crate::model::{Integrator, Model, Params};
use crate::pipeline::{position_stage, velocity_stage};
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Real, kernel};

/// The kind of acceleration that is the input of inverse dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceleration {
    /// The acceleration of forward dynamics.
    Continuous,
    /// The rate at which a step changes the velocity, (v₁ − v₀) / h.
    Discrete,
}

impl Acceleration {
    /// Returns the kind that a model selects (MuJoCo's flag `invdiscrete`).
    pub fn of(model: &Model) -> Self {
        match model.flags.invdiscrete {
            true => Acceleration::Discrete,
            false => Acceleration::Continuous,
        }
    }
}

/// Computes inverse dynamics at `state`. Writes the acceleration of forward dynamics to `ws.qacc`, the constraint
/// forces to `ws.qfrc_constraint` and the solver, and the required actuator and applied forces along dofs to
/// `qfrc_inverse` (nv). Sleeping trees take part.
pub fn inverse<T: Real>(
    context: StepContext<T>,
    state: &State<T>,
    (qacc, given): (&[T], Acceleration),
    ws: &mut Workspace<T>,
    qfrc_inverse: &mut [T],
) {
    let StepContext { model, params, .. } = context;
    position_stage(model, params, state, ws);
    detect(context, ws);
    adhesion(model, &ws.contacts, &mut ws.position);
    velocity_stage(model, params, state, ws);
    ws.qacc.copy_from_slice(qacc);
    if ws.metric.acts() {
        // The derivatives of actuators depend on their forces.
        let (pos, vel, force) = (&ws.position, &ws.velocity, &mut ws.force);
        actuation(model, params, state, pos, vel, T::ZERO, force);
        apply_metric(context, state, ws);
    } else if given == Acceleration::Discrete {
        make_continuous(model, params, state, ws);
    }
    assemble(context, state, ws);
    (ws.solver.evaluate(&ws.problem, &ws.qacc))
        .expect("the arrays of a workspace have the model's lengths");
    let constraint = ws.solver.qfrc_constraint();
    ws.qfrc_constraint.copy_from_slice(constraint);
    applied_forces(model, ws, qfrc_inverse);
    if ws.metric.acts() {
        add_metric_forces(model, params, &state.qvel, ws, qfrc_inverse);
    }
}

/// Computes τ = M a + bias − passive − Jᵀ f.
#[kernel]
fn applied_forces<T: Real>(model: &Model, ws: &Workspace<T>, qfrc_inverse: &mut [T]) {
    ws.problem.mass.mul(&model.tree, &ws.qacc, qfrc_inverse);
    for (i, force) in qfrc_inverse.iter_mut().enumerate() {
        *force += ws.force.qfrc_bias[i] - ws.force.qfrc_passive[i] - ws.qfrc_constraint[i];
    }
}

/// Converts the discrete acceleration in `ws.qacc` to the continuous one by M⁻¹ M′. A Runge-Kutta step has no such M′:
/// its acceleration is left unchanged.
fn make_continuous<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    let (pos, vel, force) = (&ws.position, &ws.velocity, &mut ws.force);
    // The derivatives of actuators depend on their forces.
    actuation(model, params, state, pos, vel, T::ZERO, force);
    let tree = &model.tree;
    match model.integrator {
        Integrator::Euler => {
            let damped = damped_lanes(model, params, ws);
            damped_inertia(model, params, &state.qvel, damped, ws);
            let matrix = &ws.integration.matrix;
            matrix.mul(tree, &ws.qacc, &mut ws.integration.qacc);
        }
        Integrator::ImplicitFast => {
            symmetric_inertia(model, params, state, ws);
            let matrix = &ws.integration.matrix;
            matrix.mul(tree, &ws.qacc, &mut ws.integration.qacc);
            add_gyroscopic_products(model, params, &state.qvel, ws);
        }
        Integrator::Implicit => {
            full_inertia(model, params, state, ws);
            let matrix = &ws.integration.full;
            matrix.mul(tree, &ws.qacc, &mut ws.integration.qacc);
        }
        Integrator::Rk4 | Integrator::Discrete => return,
    }
    ws.qacc.copy_from_slice(&ws.integration.qacc);
    ws.problem.mass_factor.solve(tree, &mut ws.qacc);
}
