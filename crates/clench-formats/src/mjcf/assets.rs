//! Textures and materials of `<asset>` are only seen, but who names one must name one that exists.

use super::document::Element;
use super::{entries, schema, sections};
use crate::LoadError;
use std::collections::BTreeSet;

/// Checks that every material that an element of the body tree names exists.
pub(crate) fn check_materials(root: &Element) -> Result<(), LoadError> {
    let materials = entries(root, "asset").filter(|asset| asset.tag == "material");
    let known = materials
        .filter_map(|material| material.text("name"))
        .collect();
    for section in sections(root, "worldbody") {
        check_below(section, &known)?;
    }
    Ok(())
}

fn check_below(element: &Element, known: &BTreeSet<&str>) -> Result<(), LoadError> {
    if let Some(name) = element
        .text("material")
        .filter(|name| !known.contains(name))
    {
        let hint = schema::suggestion(name, known.iter().copied());
        return Err(element.error(format!("there is no material \"{name}\"{hint}")));
    }
    for child in &element.children {
        check_below(child, known)?;
    }
    Ok(())
}
