//! How elements look, by names.

use super::ModelBuilder;
use crate::model::{Appearance, Material, Visuals};
use std::collections::HashMap;
use std::sync::Arc;

/// How an element looks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AppearanceSpec {
    /// Red, green, blue and opacity, each from 0 to 1; `None`: those of the material, else grey.
    pub rgba: Option<[f32; 4]>,
    /// Name of its material, or empty. A name that no material has means none.
    pub material: Arc<str>,
}

/// A surface, in MuJoCo's terms; see [`Material`].
#[derive(Clone, Debug)]
pub struct MaterialSpec {
    /// What is resolved already; its `texture` is not looked at.
    pub surface: Material,
    /// Name of its texture, or empty. A name that no texture has means none.
    pub texture: Arc<str>,
}

/// MuJoCo's defaults.
impl Default for MaterialSpec {
    fn default() -> Self {
        MaterialSpec {
            surface: Material {
                name: String::new(),
                rgba: [1.0; 4],
                texture: None,
                texrepeat: [1.0; 2],
                texuniform: false,
                emission: 0.0,
                specular: 0.5,
                shininess: 0.5,
                reflectance: 0.0,
            },
            texture: Arc::default(),
        }
    }
}

/// The materials and textures of a model, and where each name stands.
pub(super) struct Palette {
    visuals: Visuals,
    place: HashMap<String, usize>,
}

impl Palette {
    /// That of a description.
    pub(super) fn new(builder: &ModelBuilder) -> Self {
        let textures = places(builder.textures.iter().map(|texture| &texture.name));
        let material = |spec: &MaterialSpec| Material {
            texture: textures.get(&*spec.texture).copied(),
            ..spec.surface.clone()
        };
        let materials: Vec<Material> = builder.materials.iter().map(material).collect();
        Palette {
            place: places(materials.iter().map(|material| &material.name)),
            visuals: Visuals {
                materials,
                textures: builder.textures.clone(),
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

/// Where each name stands; of equal ones the first.
fn places<'a>(names: impl Iterator<Item = &'a String>) -> HashMap<String, usize> {
    let mut places = HashMap::new();
    for (place, name) in names.enumerate() {
        places.entry(name.clone()).or_insert(place);
    }
    places
}
