//! Explicit contact pairs and excludes.

use super::check::require_condim;
use super::element::Element;
use super::resolve::AllNames;
use super::{BuildError, ModelBuilder, PairSpec};
use crate::model::{Model, Pair};

/// Mixing weights below this count as zero (MuJoCo's `mjEPS`).
const NO_WEIGHT: f64 = 1e-14;

/// Adds the pairs that always collide, ordered by their bodies as in MuJoCo, and those that never do.
///
/// # Errors
/// Unknown names, a geom paired with itself, a condim that there is not.
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
        model
            .excludes
            .insert((first.min(second), first.max(second)));
    }
    Ok(())
}

/// The two geoms, that of the earlier body first.
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
    let mixed = Mixed::of(model, geoms);
    let condim = spec.condim.unwrap_or(mixed.condim);
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
    let mut ordered = geoms;
    if model.geoms[geoms[0]].kind > model.geoms[geoms[1]].kind {
        ordered.swap(0, 1);
    }
    model.pairs.push(Pair {
        name: spec.name.clone(),
        geoms: ordered,
        condim,
    });
    Ok(())
}

/// What a pair inherits from its geoms: all from that of higher priority, else maxima and weighted means.
struct Mixed {
    condim: u32,
    friction: [f64; 5],
    solref: [f64; 2],
    solimp: [f64; 5],
}

impl Mixed {
    fn of(model: &Model, [a, b]: [usize; 2]) -> Self {
        let p = &model.params;
        let priorities = [a, b].map(|g| model.geoms[g].priority);
        if priorities[0] != priorities[1] {
            let winner = if priorities[0] > priorities[1] { a } else { b };
            return Mixed {
                condim: model.geoms[winner].condim,
                friction: all_directions(p.geom_friction[winner]),
                solref: p.geom_solref[winner],
                solimp: p.geom_solimp[winner],
            };
        }
        let weight = weight(p.geom_solmix[a], p.geom_solmix[b]);
        let mean = |x: f64, y: f64| weight * x + (1.0 - weight) * y;
        let (ra, rb) = (p.geom_solref[a], p.geom_solref[b]);
        // Time constants mix; stiffnesses, which are not positive, do not: the harder wins.
        let both_times = ra[0] > 0.0 && rb[0] > 0.0;
        Mixed {
            condim: model.geoms[a].condim.max(model.geoms[b].condim),
            friction: all_directions(zip(p.geom_friction[a], p.geom_friction[b], f64::max)),
            solref: match both_times {
                true => zip(ra, rb, mean),
                false => zip(ra, rb, f64::min),
            },
            solimp: zip(p.geom_solimp[a], p.geom_solimp[b], mean),
        }
    }
}

/// Slide, spin, roll for each direction: two slides, spin, two rolls.
fn all_directions([slide, spin, roll]: [f64; 3]) -> [f64; 5] {
    [slide, slide, spin, roll, roll]
}

fn zip<const N: usize>(a: [f64; N], b: [f64; N], mix: impl Fn(f64, f64) -> f64) -> [f64; N] {
    std::array::from_fn(|i| mix(a[i], b[i]))
}

/// The first geom's share, from the `solmix` of both.
fn weight(first: f64, second: f64) -> f64 {
    match (first >= NO_WEIGHT, second >= NO_WEIGHT) {
        (true, true) => first / (first + second),
        (false, false) => 0.5,
        (false, true) => 0.0,
        (true, false) => 1.0,
    }
}
