//! What an author says about how elements look.

use clench_dynamics::model::Material;
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
