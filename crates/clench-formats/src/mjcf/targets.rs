//! Targets of cameras and lights: they must exist, even if the mode of the element ignores them.

use super::schema;
use super::sections::sections;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::BodySpec;
use std::collections::BTreeSet;

/// Checks that every target of a camera or a light is a body.
pub(super) fn check(root: &Element, bodies: &[BodySpec]) -> Result<(), LoadError> {
    let known: BTreeSet<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    for section in sections(root, "worldbody") {
        let mut pending = vec![section];
        while let Some(element) = pending.pop() {
            let target = element.text("target").filter(|name| !name.is_empty());
            if let Some(name) = target.filter(|name| !known.contains(name)) {
                let hint = schema::suggestion(name, known.iter().copied());
                let message = format!("there is no body \"{name}\" for its target{hint}");
                return Err(element.incomplete(message));
            }
            pending.extend(element.children.iter().rev());
        }
    }
    Ok(())
}
