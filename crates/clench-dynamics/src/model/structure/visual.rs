//! What is only seen. Physics never reads it; viewers do.

use super::light::{Headlight, Light};
use super::texture::Texture;

/// How the elements of a model look: an entry for each of them, in their order.
#[derive(Clone, Debug, Default)]
pub struct Visuals {
    /// Of geoms (ngeom).
    pub geoms: Vec<Appearance>,
    /// Of sites (nsite).
    pub sites: Vec<Appearance>,
    /// Of tendons (ntendon).
    pub tendons: Vec<Appearance>,
    /// Radii with which tendons are drawn, m (ntendon).
    pub tendon_width: Vec<f64>,
    /// Surfaces.
    pub materials: Vec<Material>,
    /// Pictures on surfaces.
    pub textures: Vec<Texture>,
    /// Lights, in the order of their bodies.
    pub lights: Vec<Light>,
    /// The light that goes with the camera.
    pub headlight: Headlight,
}

/// How one element looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Appearance {
    /// Red, green, blue and opacity, each from 0 to 1, where its author chose them.
    pub rgba: Option<[f32; 4]>,
    /// Its surface, a place in [`Visuals::materials`].
    pub material: Option<usize>,
}

/// The colour of what has none, as in MuJoCo.
const GREY: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

impl Visuals {
    /// The colour of an element: its own, else that of its material, else grey.
    pub fn rgba(&self, appearance: Appearance) -> [f32; 4] {
        let material = appearance.material.and_then(|m| self.materials.get(m));
        appearance
            .rgba
            .or(material.map(|material| material.rgba))
            .unwrap_or(GREY)
    }
}

/// A surface, in MuJoCo's terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Colour and opacity; it multiplies the texture's.
    pub rgba: [f32; 4],
    /// Its picture, a place in [`Visuals::textures`].
    pub texture: Option<usize>,
    /// How often a picture on a plane repeats along x and y: on the whole surface or, with `texuniform`, on two metres.
    pub texrepeat: [f32; 2],
    /// See `texrepeat`.
    pub texuniform: bool,
    /// Light that it emits, as a share of its colour.
    pub emission: f32,
    /// Strength of its highlights, from 0 to 1.
    pub specular: f32,
    /// Sharpness of its highlights, from 0 to 1.
    pub shininess: f32,
    /// How much it mirrors, from 0 to 1.
    pub reflectance: f32,
}
