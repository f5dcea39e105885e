//! The steps that are differentiated by recursion.

use clench_dynamics::Model;
use clench_dynamics::StepSettings;
use clench_dynamics::dynamics::local::is_local;
use clench_dynamics::model::{Actuator, Integrator, JointKind, Params, Transmission};
use clench_dynamics::options::ContactModel;

/// Returns true if the step of a state, without its sensors, is of a kind that recursions differentiate, as far as its
/// constraints are too.
pub(super) fn covers(model: &Model, params: &Params<f64>, settings: &StepSettings) -> bool {
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
    integrates
        && convex
        && plain
        && still
        && settings.solver.noslip_iterations == 0
        && is_local(model, params)
        && model.tendons.iter().all(|tendon| !tendon.is_spatial())
        && model
            .actuators
            .iter()
            .all(|actuator| is_straight(model, actuator))
}

/// Returns true if the arms of an actuator are constant.
fn is_straight(model: &Model, actuator: &Actuator) -> bool {
    match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => match model.joints[j].kind {
            JointKind::Hinge | JointKind::Slide => true,
            JointKind::Ball | JointKind::Free => false,
        },
        Transmission::Tendon(_) => true,
        Transmission::Site(_)
        | Transmission::SiteInFrame(_)
        | Transmission::SliderCrank(_)
        | Transmission::Body(_)
        | Transmission::Rotation(_)
        | Transmission::RotationInFrame(_) => false,
    }
}
