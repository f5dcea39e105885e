//! The steps that are differentiated by recursion.

use clench_dynamics::Model;
use clench_dynamics::StepSettings;
use clench_dynamics::dynamics::local::is_local;
use clench_dynamics::model::{Integrator, JointKind, Params};
use clench_dynamics::options::ContactModel;
use clench_rigid::State;

/// Returns true if the step of a state, without its sensors, is of a kind that recursions differentiate, as far as its
/// constraints are too.
pub(super) fn covers(
    model: &Model,
    params: &Params<f64>,
    settings: &StepSettings,
    state: &State<f64>,
) -> bool {
    let integrates = match model.integrator {
        Integrator::Euler => true,
        // The forces of a free body are integrated with their own matrix.
        Integrator::ImplicitFast => {
            let free = |joint: &clench_dynamics::model::Joint| joint.kind == JointKind::Free;
            !model.joints.iter().any(free)
        }
        Integrator::Implicit | Integrator::Rk4 | Integrator::Discrete => false,
    };
    let convex = match settings.contact_model {
        ContactModel::Convex => true,
        ContactModel::Coulomb => false,
    };
    let plain = !settings.flags.sleep && !settings.stiction && !settings.flags.diagexact;
    let still = params.geom_surfacevel.iter().flatten().all(|&v| v == 0.0);
    let unforced = (state.xfrc_applied.iter()).all(|force| force.to_array() == [0.0; 6]);
    integrates
        && convex
        && plain
        && still
        && unforced
        && settings.solver.noslip_iterations == 0
        && is_local(model, params)
}
