//! The derivatives of the springs and dampers of tendons.

use super::coordinate::{AlongForce, Coordinate};
use super::implicit::Implicit;
use super::step::Step;
use clench_dynamics::State;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::local::{tendon_damping_slope, tendon_tension};
use clench_dynamics::model::{Integrator, Params};
use clench_math::{Dual, Real};

/// Subtracts the derivatives of the tensions of all tendons from the gradient, and adds the slopes of their dampers.
pub(super) fn subtract<const K: usize>(
    step: &Step<'_>,
    (params, state): (&Params<Dual<f64, K>>, &State<Dual<f64, K>>),
    implicit: &mut Implicit,
    gradient: &mut ForceDerivatives<'_, f64>,
) {
    let (model, plain) = (step.model, step.plain);
    for t in 0..model.tendons.len() {
        let mut length = Dual::<f64, K>::new(plain.position.ten_length[t]);
        let mut velocity = Dual::<f64, K>::new(plain.velocity.ten_velocity[t]);
        length.set_derivative(0, 1.0);
        velocity.set_derivative(1, 1.0);
        let tension = tendon_tension(model, params, &state.plastic, t, (length, velocity));
        let force = AlongForce {
            value: tension.value,
            by_length: tension.derivative(0),
            by_velocity: tension.derivative(1),
        };
        if tension == Dual::ZERO {
            continue;
        }
        let along = Coordinate::of_tendon(step, t);
        let moving = |dof: usize| force.by_velocity * step.before.qvel[dof];
        along.subtract((model.nv, gradient), force, moving, |_| 1.0);
        // The damping of tendons is not part of Euler's.
        if model.integrator == Integrator::ImplicitFast && model.flags.damper {
            let slope = tendon_damping_slope(model, params, t, velocity);
            implicit.add_along(step, along, slope.value);
            implicit.add_velocity_rate(step, along, slope.derivative(1));
        }
    }
}
