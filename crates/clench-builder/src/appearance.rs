//! The author's description of the appearance of elements.

use clench_dynamics::model::Material;
use std::sync::Arc;

/// The appearance of an element.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AppearanceSpec {
    /// Red, green, blue and opacity, each from 0 to 1; `None`: those of the material, else grey.
    pub rgba: Option<[f32; 4]>,
    /// Name of its material, or empty. An unknown name means none.
    pub material: Arc<str>,
}

/// A material, in MuJoCo's terms; see [`Material`].
#[derive(Clone, Debug)]
pub struct MaterialSpec {
    /// The resolved properties; its `texture` is ignored.
    pub surface: Material,
    /// Name of its texture, or empty. An unknown name means none.
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
