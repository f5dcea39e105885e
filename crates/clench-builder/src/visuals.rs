//! The appearance of elements, by names.

use super::appearance::{AppearanceSpec, MaterialSpec};
use super::model_builder::ModelBuilder;
use clench_dynamics::model::{Appearance, Material, Visuals};
use std::collections::HashMap;

/// The materials and textures of a model, and the index of each name.
pub(super) struct Palette {
    visuals: Visuals,
    index: HashMap<String, usize>,
}

impl Palette {
    /// Creates the palette of a description.
    pub(super) fn new(builder: &ModelBuilder) -> Self {
        let textures = indices_by_name(builder.textures.iter().map(|texture| &texture.name));
        let material = |spec: &MaterialSpec| Material {
            texture: textures.get(&*spec.texture).copied(),
            ..spec.surface.clone()
        };
        let materials: Vec<Material> = builder.materials.iter().map(material).collect();
        Palette {
            index: indices_by_name(materials.iter().map(|material| &material.name)),
            visuals: Visuals {
                materials,
                textures: builder.textures.clone(),
                headlight: builder.headlight,
                ..Visuals::default()
            },
        }
    }

    /// Returns the visuals of a model without the appearance of its elements.
    pub(super) fn visuals(&self) -> Visuals {
        self.visuals.clone()
    }

    /// Resolves the material of an element's appearance.
    pub(super) fn resolve(&self, spec: &AppearanceSpec) -> Appearance {
        Appearance {
            rgba: spec.rgba,
            material: self.index.get(&*spec.material).copied(),
        }
    }
}

/// Returns the index of each name; the first if names are equal.
fn indices_by_name<'a>(names: impl Iterator<Item = &'a String>) -> HashMap<String, usize> {
    let mut indices = HashMap::new();
    for (index, name) in names.enumerate() {
        indices.entry(name.clone()).or_insert(index);
    }
    indices
}
