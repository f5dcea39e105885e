//! The sections that refer to elements of the body tree.

use super::defaults::MAIN;
use super::sections::entries;
use super::shortcut::Shortcut;
use super::source::Sources;
use super::{contact, equality, keyframe, sensor, tendon};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{ActuatorSpec, ModelBuilder, TendonSpec};
use clench_dynamics::model::SensorKind;

/// Reads contacts, equalities, tendons, actuators, sensors and keyframes.
pub(crate) fn read(
    root: &Element,
    sources: &Sources,
    builder: &mut ModelBuilder,
) -> Result<(), LoadError> {
    let classes = |element| &sources.of(element).classes;
    for element in entries(root, "contact") {
        if element.tag == "pair" {
            let pair = classes(element).of(element)?.pair.clone();
            builder.pairs.push(contact::finish_pair(element, pair)?);
        } else {
            builder.excludes.push(contact::read_exclude(element)?);
        }
    }
    for element in entries(root, "equality") {
        let draft = classes(element).of(element)?.equality.clone();
        builder.equalities.push(equality::read(element, draft)?);
    }
    for element in entries(root, "tendon") {
        builder.tendons.push(read_tendon(element, sources)?);
    }
    for element in entries(root, "actuator") {
        builder.actuators.push(read_actuator(element, sources)?);
    }
    for element in entries(root, "sensor") {
        if let Some(kind) = SensorKind::find(&element.tag) {
            builder.sensors.push(sensor::read(element, kind)?);
        }
    }
    for element in entries(root, "keyframe") {
        builder.keyframes.push(keyframe::read(element)?);
    }
    Ok(())
}

/// Returns the shortcuts that define the actuators' parameters, themselves or by their class.
///
/// # Errors
/// Returns an error if a class does not exist.
pub(crate) fn shortcuts(root: &Element, sources: &Sources) -> Result<Vec<Shortcut>, LoadError> {
    let of_element = |element: &Element| match Shortcut::from_tag(&element.tag) {
        None | Some(Shortcut::General) => {
            let classes = &sources.of(element).classes;
            Ok(classes.of(element)?.actuator.parameters.shortcut)
        }
        Some(shortcut) => Ok(shortcut),
    };
    entries(root, "actuator").map(of_element).collect()
}

pub(crate) fn read_tendon(element: &Element, sources: &Sources) -> Result<TendonSpec, LoadError> {
    let draft = sources.of(element).classes.of(element)?.tendon.clone();
    let mut tendon = tendon::read(element, draft)?;
    let resolve = |what, range, said| sources.resolve_limit(element, what, range, said);
    resolve("", tendon.range, &mut tendon.limited)?;
    resolve(
        "actuatorfrc",
        tendon.actuatorfrcrange,
        &mut tendon.actuatorfrclimited,
    )?;
    Ok(tendon)
}

/// Reads an actuator, starting from its class.
pub(crate) fn read_actuator(
    element: &Element,
    sources: &Sources,
) -> Result<ActuatorSpec, LoadError> {
    let classes = &sources.of(element).classes;
    let class = classes.named_by(element, "class", MAIN)?;
    let shortcut = Shortcut::from_tag(&element.tag).unwrap_or_default();
    let mut draft = classes[class].actuator.clone();
    draft.read(element, shortcut, classes.parameters(class, shortcut))?;
    let mut actuator = draft.finish(element)?;
    let resolve = |what, range, said| sources.resolve_limit(element, what, range, said);
    resolve("ctrl", actuator.ctrlrange, &mut actuator.ctrllimited)?;
    resolve("force", actuator.forcerange, &mut actuator.forcelimited)?;
    resolve("act", actuator.actrange, &mut actuator.actlimited)?;
    Ok(actuator)
}
