//! Explicit contact pairs and excludes.

use super::check::require_condim;
use super::element::Element;
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::{BuildError, PairSpec};
use clench_dynamics::contact::mixed_params;
use clench_dynamics::model::{Model, Pair};

/// Mixing weights below this count as zero in pairs (MuJoCo's `mjEPS`).
const NO_WEIGHT: f64 = 1e-14;

/// Adds the pairs that always collide, ordered by their bodies as in MuJoCo, and those that never do.
///
/// # Errors
/// Returns an error for an unknown name, a geom paired with itself, or an invalid condim.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    let mut pairs = Vec::new();
    for spec in &builder.pairs {
        let geoms = pair_geoms(spec, names, model)?;
        pairs.push((geoms.map(|g| model.geoms[g].body), geoms, spec));
    }
    pairs.sort_by_key(|&(bodies, ..)| bodies);
    for (_, geoms, spec) in pairs {
        add_pair(spec, geoms, model)?;
    }
    for spec in &builder.excludes {
        let first = names.bodies.find(&spec.body1, spec)? as u32;
        let second = names.bodies.find(&spec.body2, spec)? as u32;
        let bodies = (first.min(second), first.max(second));
        model.excludes.insert(bodies);
        if !spec.name.is_empty() {
            let named = model.exclude_names.entry(bodies);
            named.or_insert_with(|| spec.name.clone());
        }
    }
    Ok(())
}

/// Returns the two geoms, that of the earlier body first.
fn pair_geoms(spec: &PairSpec, names: &AllNames, model: &Model) -> Result<[usize; 2], BuildError> {
    let mut geoms = [
        names.geoms.find(&spec.geom1, spec)?,
        names.geoms.find(&spec.geom2, spec)?,
    ];
    if geoms[0] == geoms[1] {
        return Err(spec.error("a geom cannot collide with itself"));
    }
    let body = |g: usize| model.geoms[g].body;
    if body(geoms[0]) > body(geoms[1]) {
        geoms.swap(0, 1);
    }
    Ok(geoms)
}

fn add_pair(spec: &PairSpec, geoms: [usize; 2], model: &mut Model) -> Result<(), BuildError> {
    let mixed = mixed_params(model, &model.params, geoms, NO_WEIGHT);
    let condim = spec.condim.unwrap_or(mixed.dim as u32);
    require_condim(spec, condim)?;
    let p = &mut model.params;
    let larger = |v: &[f64]| v[geoms[0]].max(v[geoms[1]]);
    let margin = spec.margin.unwrap_or_else(|| larger(&p.geom_margin));
    let gap = spec.gap.unwrap_or_else(|| larger(&p.geom_gap));
    p.pair_friction
        .push(spec.friction.unwrap_or(mixed.friction));
    p.pair_solref.push(spec.solref.unwrap_or(mixed.solref));
    p.pair_solreffriction
        .push(spec.solreffriction.unwrap_or_default());
    p.pair_solimp.push(spec.solimp.unwrap_or(mixed.solimp));
    p.pair_margin.push(margin);
    p.pair_gap.push(gap);
    p.pair_adhesion
        .push(spec.adhesion.unwrap_or(mixed.adhesion));
    model.pairs.push(Pair {
        name: spec.name.clone(),
        geoms,
        condim,
    });
    Ok(())
}
