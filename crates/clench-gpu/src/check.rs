//! Model features that the device does not support yet, in one table. Everything that is not refused here is supported.

use crate::error::{GpuError, Refusal};
use crate::methods::points_of_pair;
use clench_rigid::contact::Candidate;
use clench_rigid::model::Model;
use clench_rigid::options::ContactModel;
use clench_rigid::settings::StepSettings;
use clench_solver::ConstraintSolver;

/// The simulation that a batch is to step.
pub(crate) struct Simulation<'a> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    /// The pairs of geoms that may collide.
    pub candidates: &'a [Candidate],
}

/// An unsupported feature, and a function that finds the first element that uses it.
struct Rule {
    reason: &'static str,
    find: fn(&Simulation) -> Option<String>,
}

macro_rules! rules {
    ($($reason:literal: $find:expr;)*) => {
        const RULES: &[Rule] = &[$(Rule { reason: $reason, find: $find }),*];
    };
}

rules! {
    "a model without degrees of freedom has nothing to step": |s| (s.model.nv == 0).then(|| "model".to_owned());
    "Coulomb's law needs Newton's method": |s| {
        let coulomb = s.settings.contact_model == ContactModel::Coulomb;
        let cg = s.settings.solver.constraint_solver == ConstraintSolver::Cg;
        (coulomb && cg).then(|| "option contact_model".to_owned())
    };
    "contacts between these two kinds of shape are not supported yet": |s| {
        let unknown = |c: &&Candidate| points_of_pair(c.kinds) == 0;
        let candidate = s.candidates.iter().find(unknown)?;
        let [a, b] = candidate.geoms.map(|g| geom_name(s.model, g as usize));
        Some(format!("{a} and {b}"))
    };
}

/// Refuses unsupported models.
///
/// # Errors
/// Returns the first element that violates each rule.
pub(crate) fn check(simulation: &Simulation) -> Result<(), GpuError> {
    let refuse = |rule: &Rule| {
        let element = (rule.find)(simulation)?;
        let reason = rule.reason;
        Some(Refusal { element, reason })
    };
    let refusals: Vec<_> = RULES.iter().filter_map(refuse).collect();
    if refusals.is_empty() {
        return Ok(());
    }
    Err(GpuError::Unsupported(refusals))
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

fn named(kind: &str, name: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => format!("{kind} \"{name}\""),
    }
}
