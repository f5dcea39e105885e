//! `<asset>`: meshes and height fields. Textures and materials are only seen, but who names one must name one that exists, and rays
//! pass through what cannot be seen.

use super::document::Element;
use super::source::Sources;
use super::{entries, hfield, schema, sections};
use crate::LoadError;
use crate::spending::Spending;
use clench_rigid::builder::ModelBuilder;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

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
                let mesh = draft.finish(element, &source.files, spending)?;
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

/// Checks that every material that an element of the body tree names exists.
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
    let unknown = |name: &&str| !known.contains(name);
    match element.text("material").filter(unknown) {
        Some(name) => {
            let hint = schema::suggestion(name, known.iter().copied());
            Err(element.error(format!("there is no material \"{name}\"{hint}")))
        }
        None => Ok(()),
    }
}

/// What is needed of materials to know what can be seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Visibility {
    /// Whether each material can be seen.
    materials: BTreeMap<String, bool>,
    /// The materials that meshes lend to geoms without one.
    meshes: BTreeMap<String, String>,
}

impl Visibility {
    /// Reads the materials, and which meshes have one.
    pub fn read(root: &Element, sources: &Sources) -> Result<Self, LoadError> {
        let mut visibility = Visibility::default();
        for asset in entries(root, "asset") {
            match (asset.tag.as_str(), asset.text("material")) {
                ("material", _) => {
                    let mut alpha = sources.of(asset).classes.of(asset)?.material_alpha;
                    read_alpha(asset, &mut alpha)?;
                    visibility
                        .materials
                        .insert(asset.string("name"), alpha != 0.0);
                }
                ("mesh", Some(material)) => {
                    let file = asset
                        .text("file")
                        .and_then(|file| Path::new(file).file_stem());
                    let stem = file.map(|stem| stem.to_string_lossy().into_owned());
                    let name = asset.text("name").map(str::to_owned).or(stem);
                    visibility
                        .meshes
                        .insert(name.unwrap_or_default(), material.to_owned());
                }
                _ => {}
            }
        }
        Ok(visibility)
    }

    /// Whether a geom can be seen: by its material or that of its mesh, or without one by its own colour.
    pub fn shows(&self, alpha: f64, material: &str, mesh: &str) -> bool {
        let lent = self.meshes.get(mesh).filter(|_| material.is_empty());
        let material = lent.map_or(material, String::as_str);
        self.materials
            .get(material)
            .copied()
            .unwrap_or(alpha != 0.0)
    }
}

/// Overwrites the opacity if the element gives a colour.
pub(crate) fn read_alpha(element: &Element, alpha: &mut f64) -> Result<(), LoadError> {
    if let Some([.., given]) = element.numbers::<4>("rgba")? {
        *alpha = given;
    }
    Ok(())
}
