//! Appearance. Viewers read it; physics does not.

use super::light::{Headlight, Light};
use super::texture::Texture;

/// The appearance of the elements of a model: an entry for each of them, in their order.
#[derive(Clone, Debug, Default)]
pub struct Visuals {
    /// Appearance of geoms (ngeom).
    pub geoms: Vec<Appearance>,
    /// Appearance of sites (nsite).
    pub sites: Vec<Appearance>,
    /// Appearance of tendons (ntendon).
    pub tendons: Vec<Appearance>,
    /// Radii of drawn tendons, m (ntendon).
    pub tendon_width: Vec<f64>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Lights, in the order of their bodies.
    pub lights: Vec<Light>,
    /// The light at the camera.
    pub headlight: Headlight,
}

/// The appearance of one element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Appearance {
    /// Red, green, blue and opacity, each from 0 to 1, if its author chose them.
    pub rgba: Option<[f32; 4]>,
    /// Its material, an index in [`Visuals::materials`].
    pub material: Option<usize>,
}

/// The default colour, as in MuJoCo.
const GREY: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

impl Visuals {
    /// Returns the colour of an element: its own, else that of its material, else grey.
    pub fn rgba(&self, appearance: Appearance) -> [f32; 4] {
        let material = appearance.material.and_then(|m| self.materials.get(m));
        appearance
            .rgba
            .or(material.map(|material| material.rgba))
            .unwrap_or(GREY)
    }
}

/// A material, in MuJoCo's terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Colour and opacity; it multiplies the texture's.
    pub rgba: [f32; 4],
    /// Its texture, an index in [`Visuals::textures`].
    pub texture: Option<usize>,
    /// Repetitions of a texture on a plane along x and y: on the whole surface or, with `texuniform`, on two metres.
    pub texrepeat: [f32; 2],
    /// See `texrepeat`.
    pub texuniform: bool,
    /// Emitted light, as a fraction of its colour.
    pub emission: f32,
    /// Strength of its highlights, from 0 to 1.
    pub specular: f32,
    /// Sharpness of its highlights, from 0 to 1.
    pub shininess: f32,
    /// Reflectance, from 0 to 1.
    pub reflectance: f32,
}
