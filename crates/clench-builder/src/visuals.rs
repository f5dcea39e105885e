//! How elements look, by names.

use super::appearance::{AppearanceSpec, MaterialSpec};
use super::model_builder::ModelBuilder;
use clench_dynamics::model::{Appearance, Material, Visuals};
use std::collections::HashMap;

/// The materials and textures of a model, and where each name stands.
pub(super) struct Palette {
    visuals: Visuals,
    place: HashMap<String, usize>,
}

impl Palette {
    /// That of a description.
    pub(super) fn new(builder: &ModelBuilder) -> Self {
        let textures = indices_by_name(builder.textures.iter().map(|texture| &texture.name));
        let material = |spec: &MaterialSpec| Material {
            texture: textures.get(&*spec.texture).copied(),
            ..spec.surface.clone()
        };
        let materials: Vec<Material> = builder.materials.iter().map(material).collect();
        Palette {
            place: indices_by_name(materials.iter().map(|material| &material.name)),
            visuals: Visuals {
                materials,
                textures: builder.textures.clone(),
                headlight: builder.headlight,
                ..Visuals::default()
            },
        }
    }

    /// What a model has before any element has its appearance.
    pub(super) fn visuals(&self) -> Visuals {
        self.visuals.clone()
    }

    /// How an element looks, its material found.
    pub(super) fn resolve(&self, spec: &AppearanceSpec) -> Appearance {
        Appearance {
            rgba: spec.rgba,
            material: self.place.get(&*spec.material).copied(),
        }
    }
}

/// The index of each name; of equal ones the first.
fn indices_by_name<'a>(names: impl Iterator<Item = &'a String>) -> HashMap<String, usize> {
    let mut indices = HashMap::new();
    for (index, name) in names.enumerate() {
        indices.entry(name.clone()).or_insert(index);
    }
    indices
}
