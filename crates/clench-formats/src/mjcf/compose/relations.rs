//! Elements outside the body tree that refer to it, and their copying with an attached or replicated part of the tree.
//!
//! As in MuJoCo 4.0, an element is copied if all its references resolve under their new names. For a contact pair, an
//! exclusion and a sensor with two objects one of them suffices, and for a tendon one element of its path: the others
//! are then resolved under their old names. Elements without references, such as a clock, are always copied; an
//! actuator of the world never.

use super::names::{Kind, Names, Namespace, Reference, is_world, references};
use crate::mjcf::document::Element;
use std::collections::HashSet;

/// The sections whose elements are copied with their targets, in the order of copying.
pub(super) const FOLLOWING: [&str; 6] = [
    "contact", "tendon", "equality", "actuator", "sensor", "custom",
];

/// Returns true if an element of a section can be copied with a part of its own model; user numbers and texts cannot.
pub(super) fn follows(section: &str, element: &Element) -> bool {
    section != "custom" || element.tag == "tuple"
}

/// The outcome for references that are resolved together.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Renamed,
    Kept,
    Lost,
}

/// Copies an element into a namespace, if its references resolve there.
pub(super) fn copy(
    section: &str,
    element: &Element,
    namespace: &Namespace,
    names: &Names,
) -> Option<Element> {
    let mut copy = element.clone();
    let mut fates = Vec::new();
    match section {
        "contact" | "sensor" => {
            for reference in references(element) {
                fates.push(follow(&mut copy, &[reference], namespace, names));
            }
            if brings_mesh(section, element, namespace, names) {
                fates.push(Fate::Renamed);
            }
        }
        "tendon" => {
            for wrap in &mut copy.children {
                let group = references(wrap);
                if !group.is_empty() {
                    fates.push(follow(wrap, &group, namespace, names));
                }
            }
        }
        _ => {
            let parts = std::iter::once(element).chain(&element.children);
            // The world is shared, but an actuator of it belongs to its own model.
            let acts_on_world =
                |kind: Kind, name: &str| section == "actuator" && is_world(kind, name);
            let renamed = |part: &Element| {
                references(part).iter().all(|reference| {
                    let name = target(part, *reference, namespace);
                    names.has(reference.kind, &name) && !acts_on_world(reference.kind, &name)
                })
            };
            if !parts.clone().all(renamed) {
                return None;
            }
            rename_references(&mut copy, namespace);
            copy.children
                .iter_mut()
                .for_each(|part| rename_references(part, namespace));
        }
    }
    let stays = !fates.is_empty() && !fates.contains(&Fate::Renamed);
    if stays || fates.contains(&Fate::Lost) {
        return None;
    }
    namespace.rename(&mut copy);
    namespace.rename_assets_of(&mut copy);
    Some(copy)
}

/// Returns true if a sensor measures with a mesh of the attached model; its geom may then be one of the other model.
fn brings_mesh(section: &str, element: &Element, namespace: &Namespace, names: &Names) -> bool {
    let is_new = |mesh: &str| names.has(Kind::Mesh, &namespace.apply(mesh));
    section == "sensor" && namespace.foreign && element.text("mesh").is_some_and(is_new)
}

/// Returns the new name of a reference's target.
fn target(element: &Element, reference: Reference, namespace: &Namespace) -> String {
    namespace.refer(reference.kind, &element.attributes[reference.attribute].1)
}

fn rename_references(element: &mut Element, namespace: &Namespace) {
    for reference in references(element) {
        let new = target(element, reference, namespace);
        element.attributes[reference.attribute].1 = new;
    }
}

/// Renames references if the new names exist; otherwise leaves them unchanged if the old ones do.
fn follow(
    element: &mut Element,
    group: &[Reference],
    namespace: &Namespace,
    names: &Names,
) -> Fate {
    let old = |r: &Reference| (r.kind, element.attributes[r.attribute].1.clone());
    let is_new = |r: &Reference| {
        let (kind, name) = old(r);
        !is_world(kind, &name) && names.has(kind, &namespace.refer(kind, &name))
    };
    if group.iter().all(is_new) {
        for &reference in group {
            let new = target(element, reference, namespace);
            element.attributes[reference.attribute].1 = new;
        }
        return Fate::Renamed;
    }
    let is_there = |r: &Reference| {
        let (kind, name) = old(r);
        names.has(kind, &name)
    };
    match group.iter().all(is_there) {
        true => Fate::Kept,
        false => Fate::Lost,
    }
}

/// Returns true if all references of an element exist.
pub(super) fn resolves(element: &Element, names: &Names) -> bool {
    let parts = std::iter::once(element).chain(&element.children);
    parts.into_iter().all(|part| {
        let exists = |r: &Reference| names.has(r.kind, &part.attributes[r.attribute].1);
        references(part).iter().all(exists)
    })
}

/// Returns true if an element refers to one of these, or has no references.
pub(super) fn concerns(element: &Element, these: &HashSet<(Kind, String)>) -> bool {
    let mut count = 0;
    for part in std::iter::once(element).chain(&element.children) {
        for reference in references(part) {
            let name = part.attributes[reference.attribute].1.clone();
            if these.contains(&(reference.kind, name)) {
                return true;
            }
            count += 1;
        }
    }
    count == 0
}
