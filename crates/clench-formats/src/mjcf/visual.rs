//! Visual elements: the materials and textures of a file.

use super::appearance::read_material;
use super::sections::entries;
use super::source::Sources;
use super::{light, schema, texture};
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{MaterialSpec, ModelBuilder};
use clench_dynamics::model::{Material, Texture};
use std::collections::BTreeSet;

/// Reads the materials and textures.
pub(crate) fn read(
    root: &Element,
    sources: &Sources,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    let discarded = sources.main().spec.discardvisual;
    for element in entries(root, "asset") {
        let size = match element.tag.as_str() {
            "material" => {
                let draft = sources.of(element).classes.of(element)?.material.clone();
                builder.materials.push(finish_material(element, draft)?);
                size_of::<MaterialSpec>() + size_of::<Material>()
            }
            // As in MuJoCo, discarded elements are not read.
            "texture" if discarded => continue,
            "texture" => {
                let files = &sources.of(element).files;
                let found = texture::read(element, files, spending)?;
                if found.is_none() {
                    let note = "is not drawn: of textures only PNG images are read";
                    builder.notes.push(element.error(note).to_string());
                }
                builder.textures.extend(found);
                2 * size_of::<Texture>()
            }
            _ => continue,
        };
        spending
            .bytes(size as u64)
            .map_err(|excess| element.error(excess))?;
    }
    for element in entries(root, "visual").filter(|element| element.tag == "headlight") {
        light::read_headlight(element, &mut builder.headlight)?;
    }
    for element in entries(root, "visual").filter(|element| element.tag == "map") {
        element.set_number("znear", &mut builder.znear)?;
        if builder.znear <= 0.0 || builder.znear.is_infinite() {
            return Err(element.error("znear must be positive and finite"));
        }
    }
    match discarded {
        true => Ok(()),
        false => check_textures(root, sources, builder),
    }
}

/// Checks that every texture that a material refers to exists.
fn check_textures(
    root: &Element,
    sources: &Sources,
    builder: &ModelBuilder,
) -> Result<(), LoadError> {
    let textures = entries(root, "asset").filter(|asset| asset.tag == "texture");
    let known: BTreeSet<&str> = (textures.filter_map(|texture| texture.text("name")))
        .chain(builder.textures.iter().map(|texture| texture.name.as_str()))
        .collect();
    let materials = entries(root, "asset").filter(|asset| asset.tag == "material");
    for element in materials {
        let class = sources.of(element).classes.of(element)?;
        let inherited = (element, Some(&*class.material.texture));
        let layers = element.children.iter().filter(|child| child.tag == "layer");
        let named = layers
            .chain([element])
            .map(|part| (part, part.text("texture")));
        let overridden = !element.children.is_empty() || element.text("texture").is_some();
        for (part, name) in named.chain((!overridden).then_some(inherited)) {
            let name = name.filter(|name| !name.is_empty());
            if let Some(name) = name.filter(|name| !known.contains(name)) {
                let hint = schema::suggestion(name, known.iter().copied());
                return Err(part.error(format!("there is no texture \"{name}\"{hint}")));
            }
        }
    }
    Ok(())
}

fn finish_material(
    element: &Element,
    mut material: MaterialSpec,
) -> Result<MaterialSpec, LoadError> {
    read_material(element, &mut material)?;
    material.surface.name = element.string("name");
    Ok(material)
}
