//! The appearance of elements: colours, materials, and their assignment to geoms.

use super::sections::entries;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{AppearanceSpec, MaterialSpec};
use clench_dynamics::model::Material;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// The colour that MuJoCo treats as unset.
const NO_COLOUR: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// Overwrites the appearance that the element gives.
pub(crate) fn read_appearance(
    element: &Element,
    appearance: &mut AppearanceSpec,
) -> Result<(), LoadError> {
    if let Some(rgba) = element.singles("rgba")? {
        appearance.rgba = (rgba != NO_COLOUR).then_some(rgba);
    }
    if let Some(material) = element.text("material") {
        appearance.material = material.into();
    }
    Ok(())
}

/// Overwrites the material properties that the element gives.
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
        if let Some([number]) = element.singles(name)? {
            *value = number;
        }
    }
    if let Some(texture) = element.text("texture") {
        material.texture = texture.into();
    }
    // A material with several layers shows its colour layer.
    let layers = element.children.iter().filter(|child| child.tag == "layer");
    for layer in layers.filter(|layer| matches!(layer.text("role"), Some("rgb" | "rgba"))) {
        material.texture = layer.string("texture").into();
    }
    Ok(())
}

/// Overwrites all numbers of an attribute.
pub(super) fn set<const N: usize>(
    element: &Element,
    name: &str,
    target: &mut [f32; N],
) -> Result<(), LoadError> {
    if let Some(numbers) = element.singles(name)? {
        *target = numbers;
    }
    Ok(())
}

/// Overwrites the leading numbers that an attribute gives.
fn set_some<const N: usize>(
    element: &Element,
    name: &str,
    target: &mut [f32; N],
) -> Result<(), LoadError> {
    let numbers = element.list_of_singles(name, N)?.unwrap_or_default();
    target[..numbers.len()].copy_from_slice(&numbers);
    Ok(())
}

/// The materials of geoms, and their visibility.
#[derive(Clone, Debug, Default)]
pub(crate) struct Palette {
    /// True for each visible material.
    visible: BTreeMap<String, bool>,
    /// The materials that geoms inherit from their meshes.
    meshes: BTreeMap<String, Arc<str>>,
}

impl Palette {
    /// Creates the palette of a model's materials and meshes.
    pub(super) fn new(root: &Element, materials: &[MaterialSpec]) -> Self {
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

    /// Returns the appearance of a mesh geom, which inherits the mesh's material by default.
    pub(super) fn of_geom(&self, appearance: AppearanceSpec, mesh: &str) -> AppearanceSpec {
        let material = match self.meshes.get(mesh) {
            Some(lent) if appearance.material.is_empty() => Arc::clone(lent),
            _ => appearance.material,
        };
        AppearanceSpec {
            material,
            ..appearance
        }
    }

    /// Returns true if a geom is visible, by its material or else by its own colour.
    pub(super) fn shows(&self, appearance: &AppearanceSpec) -> bool {
        let own = || appearance.rgba.is_none_or(|rgba| rgba[3] != 0.0);
        (self.visible.get(&*appearance.material).copied()).unwrap_or_else(own)
    }
}
