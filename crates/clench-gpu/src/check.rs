//! What of a model the device cannot do yet, as one table. Nothing is ignored: what is not refused here, the kernels do.

use crate::error::{GpuError, Refusal};
use clench_collide::ShapeKind;
use clench_rigid::contact::Candidate;
use clench_rigid::model::{
    BiasKind, DynamicsKind, GainKind, Integrator, JointKind, Model, Transmission,
};
use clench_rigid::settings::StepSettings;
use clench_solver::ConstraintSolver;

/// More dofs than this on a path from a root leave too few digits to single precision, where the mass matrix is factored as it is.
const MAX_PATH: usize = 20;

/// What rules look at.
pub(crate) struct Subject<'a> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    /// The pairs of geoms that may collide.
    pub candidates: &'a [Candidate],
}

/// One thing that cannot be done, and how to find the first element that needs it.
struct Rule {
    reason: &'static str,
    find: fn(&Subject) -> Option<String>,
}

macro_rules! rules {
    ($($reason:literal: $find:expr;)*) => {
        const RULES: &[Rule] = &[$(Rule { reason: $reason, find: $find }),*];
    };
}

rules! {
    "a model without degrees of freedom has nothing to step": |s| (s.model.nv == 0).then(|| "model".to_owned());
    "implicit integrators are not there yet; Euler and RK4 are": |s| {
        let known = matches!(s.model.integrator, Integrator::Euler | Integrator::Rk4);
        (!known).then(|| "option integrator".to_owned())
    };
    "Newton is the only solver": |s| {
        let cg = s.settings.solver.constraint_solver == ConstraintSolver::Cg;
        cg.then(|| "option constraint_solver".to_owned())
    };
    "noslip sweeps are not there yet": |s| {
        (s.settings.solver.noslip_iterations > 0).then(|| "option noslip_iterations".to_owned())
    };
    "environments do not start over by themselves yet: look at the statuses": |s| {
        s.settings.autoreset.then(|| "option autoreset".to_owned())
    };
    "sleep is not there yet": |s| s.settings.flags.sleep.then(|| "flag sleep".to_owned());
    "exact inverse inertias are not there yet": |s| s.settings.flags.diagexact.then(|| "flag diagexact".to_owned());
    "a path of more than 20 dofs from its root leaves single precision too few digits": |s| {
        let long = |&i: &usize| s.model.tree.row(i).len() > MAX_PATH;
        let dof = (0..s.model.nv).find(long)?;
        Some(joint(s.model, s.model.dofs[dof].joint))
    };
    "gravity compensation is not there yet": |s| {
        let body = s.model.params.body_gravcomp.iter().position(|&share| share != 0.0)?;
        Some(named("body", &s.model.bodies[body].name, body))
    };
    "equalities are not there yet": |s| {
        let first = s.model.equalities.first()?;
        let act = s.settings.flags.constraint && s.settings.flags.equality;
        act.then(|| named("equality", &first.name, 0))
    };
    "tendons that act are not there yet": acting_tendon;
    "actuators on anything but hinges and slides are not there yet": |s| actuator(s.model, |s, u| {
        !matches!(s.actuators[u].transmission, Transmission::Joint(j) | Transmission::JointInParent(j)
            if matches!(s.joints[j].kind, JointKind::Hinge | JointKind::Slide))
    });
    "actuators with activations, delays or several controls are not there yet": |s| actuator(s.model, |m, u| {
        let a = &m.actuators[u];
        a.dynamics != DynamicsKind::None || a.act().is_some() || a.history.is_some() || a.controls.len() != 1
    });
    "only fixed and affine gains, and affine biases, are there yet": |s| actuator(s.model, |m, u| {
        let a = &m.actuators[u];
        !matches!(a.gain, GainKind::Fixed | GainKind::Affine) || !matches!(a.bias, BiasKind::None | BiasKind::Affine)
    });
    "surfaces that move are not there yet": |s| geom(s.model, |m, g| {
        m.params.geom_surfacevel[g].iter().any(|&v| v != 0.0)
    });
    "contacts that adhere are not there yet": |s| geom(s.model, |m, g| m.params.geom_adhesion[g] != 0.0).or_else(|| {
        let pair = s.model.params.pair_adhesion.iter().position(|&a| a != 0.0)?;
        Some(named("pair", &s.model.pairs[pair].name, pair))
    });
    "the medium acts on boxes of inertia only": |s| geom(s.model, |m, g| m.geoms[g].fluid_ellipsoid);
    "of two shapes that may touch, only spheres, capsules, and these, boxes and ellipsoids on planes are there yet": |s| {
        let unknown = |c: &&Candidate| points_of_pair(c.kinds) == 0;
        let candidate = s.candidates.iter().find(unknown)?;
        let [a, b] = candidate.geoms.map(|g| geom_name(s.model, g as usize));
        Some(format!("{a} and {b}"))
    };
}

/// How many points a pair of shapes yields at most; 0 for one that is not there yet. The order is that of [`ShapeKind`].
pub(crate) fn points_of_pair(kinds: [ShapeKind; 2]) -> usize {
    use ShapeKind::{Box, Capsule, Ellipsoid, Plane, Sphere};
    match kinds {
        [Plane, Sphere | Ellipsoid] | [Sphere, Sphere | Capsule] => 1,
        [Plane, Capsule] | [Capsule, Capsule] => 2,
        [Plane, Box] => 4,
        _ => 0,
    }
}

/// Refuses what the device cannot do.
///
/// # Errors
/// The first element of each rule that is not kept.
pub(crate) fn check(subject: &Subject) -> Result<(), GpuError> {
    let refuse = |rule: &Rule| {
        let element = (rule.find)(subject)?;
        let reason = rule.reason;
        Some(Refusal { element, reason })
    };
    let refusals: Vec<_> = RULES.iter().filter_map(refuse).collect();
    if refusals.is_empty() {
        return Ok(());
    }
    Err(GpuError::Unsupported(refusals))
}

/// A tendon that pulls, brakes, is limited or has inertia. One that only has a length does nothing.
fn acting_tendon(s: &Subject) -> Option<String> {
    let (m, p) = (s.model, &s.model.params);
    let acts = |&t: &usize| {
        let tendon = &m.tendons[t];
        let higher = [p.tendon_stiffnesspoly[t], p.tendon_dampingpoly[t]];
        let linear = [
            p.tendon_stiffness[t],
            p.tendon_damping[t],
            p.tendon_armature[t],
        ];
        let numbers = linear.into_iter().chain(higher.into_iter().flatten());
        tendon.limited || tendon.frictionloss || numbers.into_iter().any(|x| x != 0.0)
    };
    let tendon = (0..m.tendons.len()).find(acts)?;
    Some(named("tendon", &m.tendons[tendon].name, tendon))
}

fn actuator(model: &Model, refused: fn(&Model, usize) -> bool) -> Option<String> {
    let u = (0..model.actuators.len()).find(|&u| refused(model, u))?;
    Some(named("actuator", &model.actuators[u].name, u))
}

fn geom(model: &Model, refused: fn(&Model, usize) -> bool) -> Option<String> {
    let g = (0..model.geoms.len()).find(|&g| refused(model, g))?;
    Some(geom_name(model, g))
}

fn geom_name(model: &Model, g: usize) -> String {
    let geom = &model.geoms[g];
    let kind = format!("{:?}", geom.kind).to_lowercase();
    let name = named(&format!("{kind} geom"), &geom.name, g);
    match &geom.origin {
        Some(origin) => format!("{origin}: {name}"),
        None => name,
    }
}

fn joint(model: &Model, j: usize) -> String {
    let joint = &model.joints[j];
    let name = named("joint", &joint.name, j);
    match &joint.origin {
        Some(origin) => format!("{origin}: {name}"),
        None => name,
    }
}

fn named(kind: &str, name: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => format!("{kind} \"{name}\""),
    }
}
