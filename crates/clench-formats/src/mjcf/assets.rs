//! `<asset>`: meshes and height fields. A referenced material must exist.

use super::sections::entries;
use super::source::Sources;
use super::{hfield, schema};
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{AppearanceSpec, ModelBuilder, Origin};
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

/// Checks that the material of every geom, site and tendon exists, whether the element, its class or its mesh names it.
pub(crate) fn check_materials(builder: &ModelBuilder) -> Result<(), LoadError> {
    let materials = builder.materials.iter();
    let known: BTreeSet<&str> = materials.map(|m| m.surface.name.as_str()).collect();
    let check = |tag: &str, name: &str, appearance: &AppearanceSpec, origin: &Option<Origin>| {
        let material = &*appearance.material;
        let Some(origin) = origin else {
            return Ok(());
        };
        if material.is_empty() || known.contains(material) {
            return Ok(());
        }
        let element = match name.is_empty() {
            true => tag.to_owned(),
            false => format!("{tag} \"{name}\""),
        };
        let hint = schema::suggestion(material, known.iter().copied());
        let message = format!("there is no material \"{material}\"{hint}");
        Err(LoadError::element(origin, element, message))
    };
    for body in &builder.bodies {
        for geom in &body.geoms {
            check("geom", &geom.name, &geom.appearance, &geom.origin)?;
        }
        for site in &body.sites {
            check("site", &site.name, &site.appearance, &site.origin)?;
        }
    }
    let mut tendons = builder.tendons.iter();
    tendons.try_for_each(|tendon| check("tendon", &tendon.name, &tendon.appearance, &tendon.origin))
}
