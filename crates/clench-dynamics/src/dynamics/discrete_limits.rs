//! The combinations that the integrator `discrete` does not support.

use crate::dynamics::metric::{Along, terms};
use crate::error::NotDiscrete;
use crate::model::{Integrator, Model, SleepPolicy};
use clench_solver::Switch;

/// Checks that a model can step in the metric: `sleep` is true if its trees may sleep, and `islands` if islands are
/// solved separately.
///
/// # Errors
/// Returns the first unsupported combination.
pub(crate) fn check_discrete(
    model: &Model,
    sleep: bool,
    islands: Switch,
) -> Result<(), NotDiscrete> {
    if model.integrator != Integrator::Discrete {
        return Ok(());
    }
    let refuse = |with: String, reason| Err(NotDiscrete { with, reason });
    if sleep && islands == Switch::Off {
        let reason = "trees that its metric couples must sleep and wake together";
        return refuse("sleep without islands".to_owned(), reason);
    }
    let coupling = terms(model).find(|along| couples_sleeping_trees(model, *along));
    if let (true, Some(along)) = (sleep, coupling) {
        let reason = "the metric couples a tree that may sleep with another tree, and the metric of a sleeping tree is undefined: \
            MuJoCo 4.0 includes the tree as free in one half of a step and omits it in the other";
        return refuse(format!("sleep and {}", name(model, along)), reason);
    }
    Ok(())
}

/// Returns true if a term acts on several trees of which one may sleep.
fn couples_sleeping_trees(model: &Model, along: Along) -> bool {
    let trees = model.trees_of(along.dofs(model));
    let may_sleep = |&tree: &usize| model.trees[tree].sleep != SleepPolicy::Never;
    trees.len() > 1 && trees.iter().any(may_sleep)
}

/// Returns the name of a term's object for errors.
fn name(model: &Model, along: Along) -> String {
    let (kind, index, name) = match along {
        Along::Tendon(t) => ("tendon", t, &model.tendons[t].name),
        Along::Output(output) => {
            let mut actuators = model.actuators.iter();
            let u = actuators.position(|actuator| actuator.outputs.contains(&output));
            let u = u.unwrap_or_default();
            ("actuator", u, &model.actuators[u].name)
        }
    };
    match name.as_str() {
        "" => format!("{kind} {index}"),
        name => format!("{kind} \"{name}\""),
    }
}
