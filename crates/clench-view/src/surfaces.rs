//! The mapping of textures to geoms, for the page and for the renderer.

use clench::Model;
use clench::collide::ShapeKind;
use clench::math::Vec3;
use clench::rigid::model::{Appearance, Pixels, Texture, TextureKind};

/// Returns the texture of an element, if its material has one that is not a sky.
pub fn texture(model: &Model, appearance: Appearance) -> Option<usize> {
    let visuals = &model.visuals;
    let material = visuals.materials.get(appearance.material?)?;
    let texture = material.texture?;
    (visuals.textures.get(texture)?.kind != TextureKind::Sky).then_some(texture)
}

/// Returns the factors from the coordinates of a point in the geom frame to texture coordinates, as in MuJoCo's
/// renderer (`render_gl3.c`): on a plane (x − ½, −y − ½), where 1 is the whole image; in a cube around the geom the
/// direction (x, y, z). For planar textures, meshes with their own texture coordinates do not need it.
///
/// `size` contains the half sizes of the shape, as in `geom_size`.
pub fn texture_scale(
    model: &Model,
    appearance: Appearance,
    kind: ShapeKind,
    size: Vec3<f64>,
) -> [f64; 3] {
    let visuals = &model.visuals;
    let material = appearance.material.and_then(|m| visuals.materials.get(m));
    let Some((material, texture)) = material.zip(texture(model, appearance)) else {
        return [1.0; 3];
    };
    let [x, y, z] = size.to_array();
    let half = match kind {
        ShapeKind::Sphere => [x; 3],
        ShapeKind::Capsule => [x, x, x + y],
        ShapeKind::Cylinder => [x, x, y],
        _ => [x, y, z],
    };
    // An infinite side has no size to fit a texture to.
    let half = half.map(|half| if half > 0.0 { half } else { 1.0 });
    let is_asset = matches!(kind, ShapeKind::Mesh | ShapeKind::HeightField);
    match visuals.textures[texture].kind {
        TextureKind::Plane => [0, 1, 2].map(|k| {
            let repeat = material.texrepeat.get(k).map_or(1.0, |&x| f64::from(x));
            match material.texuniform {
                true => 0.5 * repeat,
                false => 0.5 * repeat / half[k],
            }
        }),
        _ => match (material.texuniform, is_asset) {
            (true, true) => half,
            (true, false) | (false, true) => [1.0; 3],
            (false, false) => half.map(|half| 1.0 / half),
        },
    }
}

/// Encodes the texture as a PNG image.
pub fn png(texture: &Texture) -> Vec<u8> {
    let Pixels { width, height, rgb } = &*texture.pixels();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, *width as u32, *height as u32);
    encoder.set_color(png::ColorType::Rgb);
    // Writing to memory cannot fail; a texture without pixels gives an empty image.
    let written = (encoder.write_header()).and_then(|mut writer| writer.write_image_data(rgb));
    written.map_or(Vec::new(), |()| bytes)
}
