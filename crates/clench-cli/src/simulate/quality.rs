//! The quality of a run: a word and warnings.

use super::energy::EnergyAccount;
use clench::Model;
use clench::rigid::batch::Quality;
use clench::rigid::constraint::ConstraintSource;

/// The share of steps up to which deep contacts are tolerated.
const FEW_DEEP: f64 = 0.01;
/// The share of steps up to which violations are tolerated: many models start beyond a limit and return within a few
/// steps.
const FEW_VIOLATED: f64 = 0.05;
/// The share of steps up to which solves at the iteration limit are tolerated.
const FEW_UNCONVERGED: f64 = 0.01;
/// The threshold above which numbers are written with an exponent.
const LONG: f64 = 1e6;

/// The verdict on a run.
pub(crate) struct Verdict {
    /// `good`, or the most severe defect.
    pub word: &'static str,
    /// All defects, the most severe first.
    pub warnings: Vec<String>,
}

/// Judges a run of a model.
pub(crate) fn verdict(model: &Model, quality: &Quality, energy: Option<&EnergyAccount>) -> Verdict {
    let steps = quality.steps;
    let share = |count: u64| count as f64 / steps.max(1) as f64;
    let mut found = Vec::new();
    if let Some((envs, worst)) = energy.and_then(EnergyAccount::grown) {
        let (env, growth, supplied) = (worst.env, number(worst.growth), number(worst.supplied));
        let count = if envs == 1 {
            "1 environment".into()
        } else {
            format!("{envs} environments")
        };
        found.push((
            "energy_growth",
            format!(
                "the mechanical energy of {count} rose by more than actuators supplied: that of environment {env} by {growth} J, \
                 while actuators supplied {supplied} J: is the time step too long, or a force too stiff?"
            ),
        ));
    }
    if let Some(deepest) = quality.deepest
        && share(quality.deep) > FEW_DEEP
    {
        let [a, b] = deepest
            .geoms
            .map(|g| element("geom", &model.geoms[g].name, g));
        let (deep, depth) = (quality.deep, number(1e3 * deepest.depth));
        found.push((
            "deep_penetration",
            format!(
                "in {deep} of {steps} steps a contact was deeper than half a geom and deeper than its softness explains, at worst \
                 {depth} mm between {a} and {b}: do geoms overlap at the start, or is the time step too long?"
            ),
        ));
    }
    if let Some(worst) = quality.worst_violation
        && share(quality.violated) > FEW_VIOLATED
    {
        let which = source(model, worst.source);
        let (violated, size) = (quality.violated, number(worst.size));
        found.push((
            "constraint_violation",
            format!(
                "in {violated} of {steps} steps an equality or a limit was violated by more than 0.1 (m or rad) and by more than \
                 its softness explains, at worst {which} by {size}"
            ),
        ));
    }
    if share(quality.unconverged) > FEW_UNCONVERGED {
        let unconverged = quality.unconverged;
        found.push((
            "unconverged",
            format!(
                "the solves of {unconverged} of {steps} steps stopped at the iteration limit: see --iterations and --tolerance"
            ),
        ));
    }
    Verdict {
        word: found.first().map_or("good", |(word, _)| word),
        warnings: found.into_iter().map(|(_, warning)| warning).collect(),
    }
}

fn number(x: f64) -> String {
    if x < LONG {
        format!("{x:.3}")
    } else {
        format!("{x:.3e}")
    }
}

fn source(model: &Model, source: ConstraintSource) -> String {
    let kind = match source {
        ConstraintSource::JointLimit(_) => "the limit of joint",
        ConstraintSource::TendonLimit(_) => "the limit of tendon",
        ConstraintSource::Dynamic { .. } => "constraint at run time",
        _ => "equality",
    };
    element(kind, source.name(model), source.index())
}

/// Returns the name of an element, or its kind and index if it has none.
fn element(kind: &str, name: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => format!("{kind} {name:?}"),
    }
}
