//! `<asset>`: meshes and height fields. A referenced material must exist.

use super::sections::{entries, sections};
use super::source::Sources;
use super::{hfield, schema};
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::ModelBuilder;
use std::collections::BTreeSet;

/// Reads the meshes and height fields.
pub(crate) fn read(
    root: &Element,
    sources: &Sources,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    for element in entries(root, "asset") {
        let source = sources.of(element);
        match element.tag.as_str() {
            "mesh" => {
                let draft = source.classes.of(element)?.mesh.clone();
                let notes = &mut builder.notes;
                let files = &source.files;
                let discards = sources.main().spec.discardvisual;
                let mesh = draft.finish(element, files, discards, notes, spending)?;
                builder.meshes.push(mesh);
            }
            "hfield" => {
                let field = hfield::read(element, &source.files, spending)?;
                builder.height_fields.push(field);
            }
            _ => {}
        }
    }
    Ok(())
}

/// Checks that every material referenced in the body tree exists.
pub(crate) fn check_materials(root: &Element) -> Result<(), LoadError> {
    let materials = entries(root, "asset").filter(|asset| asset.tag == "material");
    let known = materials
        .filter_map(|material| material.text("name"))
        .collect();
    for section in sections(root, "worldbody") {
        let mut pending = vec![section];
        while let Some(element) = pending.pop() {
            check_material(element, &known)?;
            pending.extend(element.children.iter().rev());
        }
    }
    Ok(())
}

fn check_material(element: &Element, known: &BTreeSet<&str>) -> Result<(), LoadError> {
    let unknown = |name: &&str| !name.is_empty() && !known.contains(name);
    match element.text("material").filter(unknown) {
        Some(name) => {
            let hint = schema::suggestion(name, known.iter().copied());
            Err(element.error(format!("there is no material \"{name}\"{hint}")))
        }
        None => Ok(()),
    }
}
