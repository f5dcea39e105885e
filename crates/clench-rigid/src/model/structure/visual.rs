//! What is only seen. Physics never reads it; viewers do.

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
    /// How often the picture repeats along x and y: on the whole surface or, with `texuniform`, on a metre.
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

/// A picture that is computed from a few numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name.
    pub name: String,
    /// What it shows.
    pub pattern: TexturePattern,
    /// First colour.
    pub rgb1: [f32; 3],
    /// Second colour.
    pub rgb2: [f32; 3],
    /// What is drawn over it.
    pub mark: TextureMark,
    /// Colour of that.
    pub markrgb: [f32; 3],
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// What a computed texture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexturePattern {
    /// The second colour in the middle, the first at the edges.
    Gradient,
    /// Two by two fields.
    Checker,
    /// The first colour.
    Flat,
}

/// What is drawn over a computed texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureMark {
    /// Nothing.
    None,
    /// Its edges.
    Edge,
    /// A cross in the middle.
    Cross,
}
