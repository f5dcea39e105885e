//! How pictures lie on geoms, for the page and for pictures without one.

use clench::Model;
use clench::collide::ShapeKind;
use clench::math::Vec3;
use clench::rigid::model::{Appearance, Pixels, Texture, TextureKind};

/// The texture of an element, if its material has one that lies on surfaces.
pub fn texture(model: &Model, appearance: Appearance) -> Option<usize> {
    let visuals = &model.visuals;
    let material = visuals.materials.get(appearance.material?)?;
    let texture = material.texture?;
    (visuals.textures.get(texture)?.kind != TextureKind::Sky).then_some(texture)
}

/// What the coordinates of a point of a geom, in its frame, are multiplied by to find its place in a texture, as MuJoCo's renderer
/// has it (`render_gl3.c`): on a plane it is (x − ½, −y − ½), where one stands for the whole picture; in a cube around the geom it is
/// the direction (x, y, z). Meshes with texture coordinates of their own do not need it for a plane.
///
/// `size` are the half sizes of the shape, as `geom_size` has them.
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
    // A side without end has no size that pictures could fit.
    let half = half.map(|half| if half > 0.0 { half } else { 1.0 });
    let is_given = matches!(kind, ShapeKind::Mesh | ShapeKind::HeightField);
    match visuals.textures[texture].kind {
        TextureKind::Plane => [0, 1, 2].map(|k| {
            let repeat = material.texrepeat.get(k).map_or(1.0, |&x| f64::from(x));
            match material.texuniform {
                true => 0.5 * repeat,
                false => 0.5 * repeat / half[k],
            }
        }),
        _ => match (material.texuniform, is_given) {
            (true, true) => half,
            (true, false) | (false, true) => [1.0; 3],
            (false, false) => half.map(|half| 1.0 / half),
        },
    }
}

/// The picture of a texture as a PNG image.
pub fn png(texture: &Texture) -> Vec<u8> {
    let Pixels { width, height, rgb } = &*texture.pixels();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, *width as u32, *height as u32);
    encoder.set_color(png::ColorType::Rgb);
    // Nothing can fail that writes to memory; a picture without pixels is none.
    let written = (encoder.write_header()).and_then(|mut writer| writer.write_image_data(rgb));
    written.map_or(Vec::new(), |()| bytes)
}
