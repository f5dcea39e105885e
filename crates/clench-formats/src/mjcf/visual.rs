//! What is only seen: the materials of a file, and textures that are computed.

use super::appearance::{read_material, set};
use super::document::Element;
use super::sections::entries;
use super::source::Sources;
use crate::LoadError;
use crate::spending::Spending;
use clench_rigid::builder::{MaterialSpec, ModelBuilder};
use clench_rigid::model::{Material, Texture, TextureMark, TexturePattern};

/// Reads the materials and textures.
pub(crate) fn read(
    root: &Element,
    sources: &Sources,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    for element in entries(root, "asset") {
        let size = match element.tag.as_str() {
            "material" => {
                let draft = sources.of(element).classes.of(element)?.material.clone();
                builder.materials.push(finish_material(element, draft)?);
                size_of::<MaterialSpec>() + size_of::<Material>()
            }
            "texture" => {
                builder.textures.extend(read_texture(element)?);
                2 * size_of::<Texture>()
            }
            _ => continue,
        };
        spending
            .bytes(size as u64)
            .map_err(|excess| element.error(excess))?;
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

/// The largest width or height of a computed texture, pixels.
const MAX_PIXELS: i32 = 4096;

/// A texture that is computed; those of files and those of skies are not kept.
fn read_texture(element: &Element) -> Result<Option<Texture>, LoadError> {
    let patterns = [
        ("none", None),
        ("gradient", Some(TexturePattern::Gradient)),
        ("checker", Some(TexturePattern::Checker)),
        ("flat", Some(TexturePattern::Flat)),
    ];
    let pattern = element.keyword("builtin", &patterns)?.flatten();
    let sky = matches!(element.text("type"), Some("skybox"));
    let Some(pattern) = pattern.filter(|_| !sky) else {
        return Ok(None);
    };
    let marks = [
        ("none", TextureMark::None),
        ("edge", TextureMark::Edge),
        ("cross", TextureMark::Cross),
        ("random", TextureMark::None),
    ];
    let mut texture = Texture {
        name: element.string("name"),
        pattern,
        rgb1: [0.8; 3],
        rgb2: [0.5; 3],
        mark: (element.keyword("mark", &marks)?).unwrap_or(TextureMark::None),
        markrgb: [0.0; 3],
        size: [0; 2],
    };
    set(element, "rgb1", &mut texture.rgb1)?;
    set(element, "rgb2", &mut texture.rgb2)?;
    set(element, "markrgb", &mut texture.markrgb)?;
    for (name, pixels) in ["width", "height"].into_iter().zip(&mut texture.size) {
        let given = element.integer(name)?.unwrap_or(0);
        *pixels = given.clamp(0, MAX_PIXELS) as u32;
    }
    Ok(Some(texture))
}
