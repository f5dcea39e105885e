//! What is drawn now: geoms and tendons, each with its pose, colour and surface, as the shader reads them.

use clench::Model;
use clench::rigid::model::{Appearance, TextureMark, TexturePattern};
use clench::rigid::{Precision, Sim};
use clench_view::frame::tendon_spans;

/// Numbers of one thing that is drawn; see the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, zerocopy::IntoBytes, zerocopy::Immutable)]
pub struct Item {
    pub pose: [[f32; 4]; 4],
    pub color: [f32; 4],
    pub surface: [f32; 4],
    pub first: [f32; 4],
    pub second: [f32; 4],
    pub mark: [f32; 4],
    pub repeat: [f32; 4],
}

/// The looks of every geom of a model, at no place yet.
pub fn of_geoms(model: &Model, far: f32) -> Vec<Item> {
    let looks = |g: usize| {
        let size = model.params.geom_size[g].to_array().map(|x| x as f32);
        let plane = model.geoms[g].kind == clench::collide::ShapeKind::Plane;
        let mut item = look(
            model,
            model.visuals.geoms[g],
            plane.then_some([size[0], size[1]]),
            far,
        );
        item.surface[3] = g as f32;
        item
    };
    (0..model.geoms.len()).map(looks).collect()
}

/// How something looks; computed textures lie on planes, whose half sizes are given, and colour other things evenly.
fn look(model: &Model, appearance: Appearance, plane: Option<[f32; 2]>, far: f32) -> Item {
    let visuals = &model.visuals;
    let material = appearance.material.and_then(|m| visuals.materials.get(m));
    let texture = material
        .and_then(|m| m.texture)
        .and_then(|t| visuals.textures.get(t));
    let mut item = Item {
        pose: [[0.0; 4]; 4],
        color: visuals.rgba(appearance),
        surface: material.map_or([0.3, 0.3, 0.0, -1.0], |m| {
            [m.specular, m.shininess, m.emission, -1.0]
        }),
        first: [0.0; 4],
        second: [0.0; 4],
        mark: [0.0; 4],
        repeat: [0.0; 4],
    };
    let (Some(material), Some(texture)) = (material, texture) else {
        return item;
    };
    let with = |[r, g, b]: [f32; 3], w: f32| [r, g, b, w];
    let kind = match texture.pattern {
        TexturePattern::Checker => 1.0,
        TexturePattern::Flat => 2.0,
        TexturePattern::Gradient => 3.0,
    };
    let over = match texture.mark {
        TextureMark::None => 0.0,
        TextureMark::Edge => 1.0,
        TextureMark::Cross => 2.0,
    };
    let Some(half) = plane else {
        // One colour for all sides.
        item.first = with(texture.rgb1, 2.0);
        return item;
    };
    let half = half.map(|half| if half > 0.0 { half } else { far });
    let times = |k: usize| match material.texuniform {
        true => material.texrepeat[k],
        false => material.texrepeat[k] / (2.0 * half[k]),
    };
    item.first = with(texture.rgb1, kind);
    item.second = with(texture.rgb2, over);
    item.mark = with(texture.markrgb, 0.0);
    item.repeat = [times(0), times(1), half[0], half[1]];
    item
}

/// The poses of all geoms now, column by column.
pub fn poses<T: Precision>(sim: &mut Sim<T>) -> Result<Vec<[[f32; 4]; 4]>, clench::SimError> {
    let places = sim.output("geom_xpos")?;
    let turns = sim.output("geom_xmat")?;
    let number = |x: T| x.to_f64() as f32;
    let pose = |(place, turn): (&[T], &[T])| {
        let column = |k: usize| {
            [
                number(turn[k]),
                number(turn[3 + k]),
                number(turn[6 + k]),
                0.0,
            ]
        };
        let place = [number(place[0]), number(place[1]), number(place[2]), 1.0];
        [column(0), column(1), column(2), place]
    };
    Ok(places
        .chunks_exact(3)
        .zip(turns.chunks_exact(9))
        .map(pose)
        .collect())
}

/// Straight parts of tendons now, for a cylinder along z of radius 1 and half the length 1.
pub fn of_tendons<T: Precision>(sim: &mut Sim<T>) -> Result<Vec<Item>, clench::SimError> {
    sim.refresh()?;
    let mut spans = Vec::new();
    tendon_spans(sim, &mut spans);
    let model = sim.model();
    let item = |row: &[f32]| {
        let tendon = row[0] as usize;
        let mut item = look(model, model.visuals.tendons[tendon], None, 1.0);
        let radius = model.visuals.tendon_width[tendon] as f32;
        let along = [0, 1, 2].map(|k| 0.5 * (row[4 + k] - row[1 + k]));
        let half = along.iter().map(|x| x * x).sum::<f32>().sqrt();
        let ahead = along.map(|x| x / half.max(1e-9));
        // Any direction that is not along the tendon.
        let other = if ahead[2].abs() < 0.9 {
            [0.0, 0.0, 1.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let side = cross(other, ahead);
        let length = side.iter().map(|x| x * x).sum::<f32>().sqrt();
        let side = side.map(|x| x / length);
        let column =
            |v: [f32; 3], scale: f32, w: f32| [scale * v[0], scale * v[1], scale * v[2], w];
        let middle = [0, 1, 2].map(|k| 0.5 * (row[4 + k] + row[1 + k]));
        item.pose = [
            column(side, radius, 0.0),
            column(cross(ahead, side), radius, 0.0),
            column(ahead, half, 0.0),
            column(middle, 1.0, 1.0),
        ];
        item
    };
    Ok(spans.chunks_exact(7).map(item).collect())
}
