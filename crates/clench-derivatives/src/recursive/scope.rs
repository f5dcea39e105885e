//! The steps that are differentiated by recursion.

use clench_dynamics::Model;
use clench_dynamics::StepSettings;
use clench_dynamics::dynamics::gyroscopic::is_free_tree;
use clench_dynamics::dynamics::local::is_local;
use clench_dynamics::dynamics::reflected::tendon_armature;
use clench_dynamics::model::{Actuator, GainKind, Integrator, Params};
use clench_dynamics::options::ContactModel;

/// Returns true if the step of a state, without its sensors, is of a kind that recursions differentiate, as far as its
/// constraints are too.
pub(super) fn covers(model: &Model, params: &Params<f64>, settings: &StepSettings) -> bool {
    let integrates = match model.integrator {
        Integrator::Euler | Integrator::ImplicitFast => true,
        Integrator::Rk4 => model.actuators.iter().all(advances_by_rates),
        Integrator::Implicit | Integrator::Discrete => false,
    };
    let convex = match settings.contact_model {
        ContactModel::Convex => true,
        ContactModel::Coulomb => false,
    };
    let plain = !settings.flags.sleep && !settings.stiction && !settings.flags.diagexact;
    let still = params.geom_surfacevel.iter().flatten().all(|&v| v == 0.0);
    let light =
        |t: usize| !model.tendons[t].is_spatial() || tendon_armature(model, params, t) == 0.0;
    let constant_inertia = (0..model.tendons.len()).all(light);
    integrates
        && convex
        && plain
        && still
        && settings.solver.noslip_iterations == 0
        && is_local(model, params)
        && constant_inertia
}

/// Returns true if gradients of a step that recursions cover need no derivatives of the next state: it has one stage,
/// and the slopes of its forces are symmetric.
pub(super) fn pulls_back(model: &Model) -> bool {
    match model.integrator {
        Integrator::Euler => true,
        Integrator::ImplicitFast => {
            (0..model.joints.len()).all(|joint| !is_free_tree(model, joint))
        }
        Integrator::Rk4 | Integrator::Implicit | Integrator::Discrete => false,
    }
}

/// Returns true if the activations of an actuator after several stages follow from their mean rates, and no stage reads
/// delayed controls. Bristles of a motor deflect by the velocity at the start of the step.
fn advances_by_rates(actuator: &Actuator) -> bool {
    actuator.history.is_none() && (actuator.acts.is_empty() || actuator.gain != GainKind::DcMotor)
}
