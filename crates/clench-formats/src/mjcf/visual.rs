//! What is only seen: materials, textures that are computed, and the colours of elements.

use super::document::Element;
use super::entries;
use super::source::Sources;
use crate::LoadError;
use crate::spending::Spending;
use clench_rigid::builder::{AppearanceSpec, MaterialSpec, ModelBuilder};
use clench_rigid::model::{Material, Texture, TextureMark, TexturePattern};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// MuJoCo takes this colour of an element for none.
const NO_COLOUR: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// Overwrites what the element gives of its appearance.
pub(crate) fn read_appearance(
    element: &Element,
    appearance: &mut AppearanceSpec,
) -> Result<(), LoadError> {
    if let Some(rgba) = element.numbers("rgba")? {
        let rgba = rgba.map(|x: f64| x as f32);
        appearance.rgba = (rgba != NO_COLOUR).then_some(rgba);
    }
    if let Some(material) = element.text("material") {
        appearance.material = material.into();
    }
    Ok(())
}

/// Overwrites what the element gives of a material.
pub(crate) fn read_material(
    element: &Element,
    material: &mut MaterialSpec,
) -> Result<(), LoadError> {
    let surface = &mut material.surface;
    set(element, "rgba", &mut surface.rgba)?;
    set_some(element, "texrepeat", &mut surface.texrepeat)?;
    element.set_boolean("texuniform", &mut surface.texuniform)?;
    for (name, value) in [
        ("emission", &mut surface.emission),
        ("specular", &mut surface.specular),
        ("shininess", &mut surface.shininess),
        ("reflectance", &mut surface.reflectance),
    ] {
        if let Some([number]) = element.numbers(name)? {
            *value = number as f32;
        }
    }
    if let Some(texture) = element.text("texture") {
        material.texture = texture.into();
    }
    // A material of several layers shows that of its colours.
    let layers = element.children.iter().filter(|child| child.tag == "layer");
    for layer in layers.filter(|layer| matches!(layer.text("role"), Some("rgb" | "rgba"))) {
        material.texture = layer.string("texture").into();
    }
    Ok(())
}

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

/// Overwrites all numbers of an attribute.
fn set<const N: usize>(
    element: &Element,
    name: &str,
    target: &mut [f32; N],
) -> Result<(), LoadError> {
    if let Some(numbers) = element.numbers::<N>(name)? {
        *target = numbers.map(|x| x as f32);
    }
    Ok(())
}

/// Overwrites as many numbers of an attribute as it gives.
fn set_some<const N: usize>(
    element: &Element,
    name: &str,
    target: &mut [f32; N],
) -> Result<(), LoadError> {
    let mut numbers = target.map(f64::from);
    element.overlay(name, &mut numbers)?;
    *target = numbers.map(|x| x as f32);
    Ok(())
}

/// The materials that geoms have, and with them what can be seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Palette {
    /// Whether each material can be seen.
    visible: BTreeMap<String, bool>,
    /// The materials that meshes lend to geoms without one.
    meshes: BTreeMap<String, Arc<str>>,
}

impl Palette {
    /// That of a model's materials, and of the meshes that have one.
    pub fn new(root: &Element, materials: &[MaterialSpec]) -> Self {
        let visible = materials.iter().map(|material| {
            let Material { name, rgba, .. } = &material.surface;
            (name.clone(), rgba[3] != 0.0)
        });
        let mut palette = Palette {
            visible: visible.collect(),
            meshes: BTreeMap::new(),
        };
        for mesh in entries(root, "asset").filter(|asset| asset.tag == "mesh") {
            let Some(material) = mesh.text("material") else {
                continue;
            };
            let file = (mesh.text("file")).and_then(|file| Path::new(file).file_stem());
            let stem = file.map(|stem| stem.to_string_lossy().into_owned());
            let name = mesh.text("name").map(str::to_owned).or(stem);
            palette
                .meshes
                .insert(name.unwrap_or_default(), material.into());
        }
        palette
    }

    /// The appearance of a geom of a mesh, which lends its material to a geom without one.
    pub fn of_geom(&self, appearance: AppearanceSpec, mesh: &str) -> AppearanceSpec {
        let material = match self.meshes.get(mesh) {
            Some(lent) if appearance.material.is_empty() => Arc::clone(lent),
            _ => appearance.material,
        };
        AppearanceSpec {
            material,
            ..appearance
        }
    }

    /// Whether a geom can be seen: by its material, or without one by its own colour.
    pub fn shows(&self, appearance: &AppearanceSpec) -> bool {
        let own = || appearance.rgba.is_none_or(|rgba| rgba[3] != 0.0);
        (self.visible.get(&*appearance.material).copied()).unwrap_or_else(own)
    }
}
