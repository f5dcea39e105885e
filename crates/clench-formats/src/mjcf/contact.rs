//! `<contact>`: pairs that collide regardless of their masks, and bodies that never collide.

use super::geom::read_condim;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{DEFAULT_SOLIMP, DEFAULT_SOLREF, ExcludeSpec, PairSpec};

/// Returns the defaults of a pair. Pairs in files do not mix the parameters of their geoms; they have their own
/// defaults.
pub(crate) fn default_pair() -> PairSpec {
    PairSpec {
        condim: Some(3),
        friction: Some([1.0, 1.0, 0.005, 0.0001, 0.0001]),
        solref: Some(DEFAULT_SOLREF),
        solimp: Some(DEFAULT_SOLIMP),
        margin: Some(0.0),
        gap: Some(0.0),
        adhesion: Some(0.0),
        ..PairSpec::default()
    }
}

/// Overwrites the values that the element has.
pub(crate) fn read_pair(element: &Element, pair: &mut PairSpec) -> Result<(), LoadError> {
    pair.condim = read_condim(element)?.or(pair.condim);
    element.overlay_option("friction", &mut pair.friction)?;
    element.overlay_option("solref", &mut pair.solref)?;
    element.overlay_option("solreffriction", &mut pair.solreffriction)?;
    element.overlay_option("solimp", &mut pair.solimp)?;
    pair.margin = element
        .numbers("margin")?
        .map(|[margin]| margin)
        .or(pair.margin);
    pair.gap = element.numbers("gap")?.map(|[gap]| gap).or(pair.gap);
    let adhesion = element.numbers("adhesion")?;
    pair.adhesion = adhesion.map(|[force]| force).or(pair.adhesion);
    Ok(())
}

/// Returns the pair of an element in `<contact>`.
pub(crate) fn finish_pair(element: &Element, mut pair: PairSpec) -> Result<PairSpec, LoadError> {
    read_pair(element, &mut pair)?;
    Ok(PairSpec {
        name: element.string("name"),
        geom1: element.required_text("geom1")?.to_owned(),
        geom2: element.required_text("geom2")?.to_owned(),
        origin: Some(element.origin.clone()),
        ..pair
    })
}

/// Reads a pair of bodies that never collide.
pub(crate) fn read_exclude(element: &Element) -> Result<ExcludeSpec, LoadError> {
    Ok(ExcludeSpec {
        name: element.string("name"),
        body1: element.required_text("body1")?.to_owned(),
        body2: element.required_text("body2")?.to_owned(),
        origin: Some(element.origin.clone()),
    })
}
