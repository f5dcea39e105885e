//! The drawn items: geoms, sites and tendons, each with its pose, colour and surface, as the shader reads them.

use clench::Model;
use clench::collide::ShapeKind;
use clench::math::{Real, Vec3};
use clench::rigid::model::{Appearance, TextureKind};
use clench::rigid::readout::TendonLine;
use clench::rigid::{Precision, Sim};
use clench_view::surfaces::{texture, texture_scale};

/// The parameters of one drawn item; see the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, zerocopy::IntoBytes, zerocopy::Immutable)]
pub(crate) struct Item {
    pub pose: [[f32; 4]; 4],
    /// The factors of the design's size along the axes, and how far the halves of a capsule move apart, m.
    pub stretch: [f32; 4],
    pub color: [f32; 4],
    pub surface: [f32; 4],
    pub lines: [f32; 4],
}

/// The stretch of an item of its design's size.
const UNSTRETCHED: [f32; 4] = [1.0, 1.0, 1.0, 0.0];

/// The properties of an item that decide its vertices.
#[derive(PartialEq)]
pub(crate) struct Design {
    pub kind: ShapeKind,
    /// The mesh or the height field.
    asset: Option<usize>,
    pub size: [f64; 3],
    /// The kind and the scale of the texture.
    pub texture: Option<(TextureKind, [f64; 3])>,
}

impl Design {
    /// Returns the design of a geom.
    pub(crate) fn of_geom(model: &Model, geom: usize) -> Self {
        let described = &model.geoms[geom];
        let asset = described.mesh.or(described.height_field);
        let size = model.params.geom_size[geom];
        Self::new(
            model,
            model.visuals.geoms[geom],
            described.kind,
            size,
            asset,
        )
    }

    /// Returns the design of a site.
    pub(crate) fn of_site(model: &Model, site: usize) -> Self {
        let size = model.params.site_size[site];
        Self::new(
            model,
            model.visuals.sites[site],
            model.sites[site].kind,
            size,
            None,
        )
    }

    fn new(
        model: &Model,
        appearance: Appearance,
        kind: ShapeKind,
        size: Vec3<f64>,
        asset: Option<usize>,
    ) -> Self {
        let scale = |t: usize| {
            let scale = texture_scale(model, appearance, kind, size);
            (model.visuals.textures[t].kind, scale)
        };
        let texture = texture(model, appearance).map(scale);
        let own_size = match kind {
            ShapeKind::Plane | ShapeKind::Mesh | ShapeKind::HeightField => true,
            ShapeKind::Sphere
            | ShapeKind::Capsule
            | ShapeKind::Cylinder
            | ShapeKind::Ellipsoid
            | ShapeKind::Box => false,
        };
        Design {
            kind,
            asset,
            // Without a texture one shape serves for all sizes.
            size: match own_size || texture.is_some() {
                true => size.to_array(),
                false => [1.0; 3],
            },
            texture,
        }
    }
}

/// The surface of an item, for which the shader is specialized; see there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Surface {
    Plain,
    Lines,
    Plane,
    Cube,
}

impl Surface {
    pub(crate) const COUNT: usize = 4;

    /// Returns the surface of an item with a texture or without.
    pub(crate) fn new(model: &Model, item: &Item, texture: Option<usize>) -> Self {
        match texture.map(|texture| model.visuals.textures[texture].kind) {
            Some(TextureKind::Plane) => Surface::Plane,
            Some(TextureKind::Cube) => Surface::Cube,
            _ if item.lines[0] > 0.0 => Surface::Lines,
            _ => Surface::Plain,
        }
    }
}

/// Converts a colour of a screen to linear values.
fn linear([r, g, b]: [f32; 3]) -> [f32; 3] {
    [r, g, b].map(|x| x.powf(2.2))
}

/// Returns the items of every geom of a model and then of every site, without poses.
pub(crate) fn of_model(model: &Model) -> Vec<Item> {
    let visuals = &model.visuals;
    let geoms = visuals.geoms.iter().enumerate().map(|(g, &appearance)| {
        let mut item = item_of(model, appearance);
        item.surface[3] = g as f32;
        let size = model.params.geom_size[g];
        let endless = model.geoms[g].kind == ShapeKind::Plane && size.x.min(size.y) <= 0.0;
        item.lines[2] = f32::from(u8::from(endless));
        item
    });
    let sites = visuals
        .sites
        .iter()
        .map(|&appearance| item_of(model, appearance));
    geoms.chain(sites).collect()
}

/// Adds the ground of an image, as on the viewer's page: grid lines on the lowest plane of the world, or below a model
/// that has no ground. A floor with a texture needs none. Returns an item in the case without ground, which follows
/// geoms and sites.
pub(crate) fn add_ground(
    model: &Model,
    items: &mut [Item],
    extent: f32,
    lowest: f32,
) -> Option<Item> {
    let cell = match extent {
        1.2.. => 0.5,
        0.25.. => 0.1,
        _ => 0.02,
    };
    let kind_of = |g: usize| model.geoms[g].kind;
    let height = |g: usize| model.params.geom_pos[g].z;
    let floors = (0..model.geoms.len())
        .filter(|&g| kind_of(g) == ShapeKind::Plane && model.geoms[g].body == 0);
    if let Some(floor) = floors.min_by(|&a, &b| height(a).total_cmp(&height(b))) {
        if texture(model, model.visuals.geoms[floor]).is_none() {
            items[floor].lines[0] = cell;
        }
        return None;
    }
    if (0..model.geoms.len()).any(|g| kind_of(g) == ShapeKind::HeightField) {
        return None;
    }
    let column = |k: usize| [0, 1, 2, 3].map(|row| f32::from(u8::from(row == k)));
    Some(Item {
        pose: [column(0), column(1), column(2), [0.0, 0.0, lowest, 1.0]],
        stretch: UNSTRETCHED,
        color: [0.0; 4],
        surface: [0.0, 0.0, 0.0, -1.0],
        lines: [cell, 1.0, 1.0, 0.0],
    })
}

/// Returns the approximate lowest height of the movable geoms, or of all if none is movable, m.
pub(crate) fn lowest<T: Precision>(sim: &mut Sim<T>) -> Result<f32, clench::SimError> {
    let poses = poses_of(sim, "geom_xpos", "geom_xmat")?;
    let model = sim.model();
    let bottom = |g: usize| {
        let size = model.params.geom_size[g].norm().min(5.0);
        poses[g][3][2] - 0.6 * size as f32
    };
    let all = 0..model.geoms.len();
    let moving = all.clone().filter(|&g| model.geoms[g].body > 0);
    let least = |z: f32, g: usize| z.min(bottom(g));
    let low = moving.fold(f32::INFINITY, least);
    let low = if low.is_finite() {
        low
    } else {
        all.fold(f32::INFINITY, least)
    };
    Ok(if low.is_finite() { low } else { 0.0 })
}

/// Returns the colour of an item as its shader needs it: daylight is added in linear values, the light of a file in
/// those of a screen.
pub(crate) fn shown(model: &Model, [r, g, b, opacity]: [f32; 4]) -> [f32; 4] {
    let [r, g, b] = match model.visuals.lights.is_empty() {
        true => linear([r, g, b]),
        false => [r, g, b],
    };
    [r, g, b, opacity]
}

/// Returns the item of an element. Without a material it has MuJoCo's default highlights.
fn item_of(model: &Model, appearance: Appearance) -> Item {
    let visuals = &model.visuals;
    let material = appearance.material.and_then(|m| visuals.materials.get(m));
    Item {
        pose: [[0.0; 4]; 4],
        stretch: UNSTRETCHED,
        color: shown(model, visuals.rgba(appearance)),
        surface: material.map_or([0.5, 0.5, 0.0, -1.0], |m| {
            [m.specular, m.shininess, m.emission, -1.0]
        }),
        lines: [0.0; 4],
    }
}

/// Returns the present poses of all geoms, then of all sites, in column-major order.
pub(crate) fn poses<T: Precision>(
    sim: &mut Sim<T>,
) -> Result<Vec<[[f32; 4]; 4]>, clench::SimError> {
    let mut poses = poses_of(sim, "geom_xpos", "geom_xmat")?;
    if !sim.model().sites.is_empty() {
        poses.extend(poses_of(sim, "site_xpos", "site_xmat")?);
    }
    Ok(poses)
}

/// Returns the stretch of each geom, then of each site, from the sizes of their designs to those of a simulation; `far`
/// is the size of an infinite plane, m.
pub(crate) fn stretches<T: Precision>(sim: &Sim<T>, far: f32) -> Vec<[f32; 4]> {
    let (model, own) = (sim.model(), sim.params());
    let wide = |size: Vec3<T::SingleEnv>| size.to_array().map(|x| x.lane(0).to_f64());
    let geoms = (0..model.geoms.len()).map(|g| {
        let design = Design::of_geom(model, g);
        stretch(design.kind, [wide(own.geom_size[g]), design.size], far)
    });
    let sites = (0..model.sites.len()).map(|s| {
        let design = Design::of_site(model, s);
        stretch(design.kind, [wide(own.site_size[s]), design.size], far)
    });
    geoms.chain(sites).collect()
}

/// Returns the stretch of a shape to the first of two sizes.
fn stretch(kind: ShapeKind, [own, design]: [[f64; 3]; 2], far: f32) -> [f32; 4] {
    let factor = |own: f64, design: f64| match own == design {
        true => 1.0,
        false => (own / design) as f32,
    };
    let [x, y, z] = [0, 1, 2].map(|k| factor(own[k], design[k]));
    let reach = |side: f64| if side > 0.0 { side } else { f64::from(far) };
    match kind {
        ShapeKind::Sphere => [x, x, x, 0.0],
        ShapeKind::Capsule | ShapeKind::Cylinder => {
            [x, x, x, (own[1] - f64::from(x) * design[1]) as f32]
        }
        ShapeKind::Ellipsoid | ShapeKind::Box => [x, y, z, 0.0],
        ShapeKind::Plane => {
            let [x, y] = [0, 1].map(|k| factor(reach(own[k]), reach(design[k])));
            [x, y, 1.0, 0.0]
        }
        // Their sizes are those of their assets.
        ShapeKind::Mesh | ShapeKind::HeightField => UNSTRETCHED,
    }
}

fn poses_of<T: Precision>(
    sim: &mut Sim<T>,
    places: &str,
    rotations: &str,
) -> Result<Vec<[[f32; 4]; 4]>, clench::SimError> {
    let places = sim.output(places)?;
    let rotations = sim.output(rotations)?;
    let number = |x: T| x.to_f64() as f32;
    let pose = |(position, rotation): (&[T], &[T])| {
        let column = |k: usize| {
            [
                number(rotation[k]),
                number(rotation[3 + k]),
                number(rotation[6 + k]),
                0.0,
            ]
        };
        let position = [
            number(position[0]),
            number(position[1]),
            number(position[2]),
            1.0,
        ];
        [column(0), column(1), column(2), position]
    };
    Ok(places
        .chunks_exact(3)
        .zip(rotations.chunks_exact(9))
        .map(pose)
        .collect())
}

/// Returns the present straight segments of tendons, for a cylinder along z of radius 1 and half length 1.
pub(crate) fn of_tendons<T: Precision>(sim: &mut Sim<T>) -> Result<Vec<Item>, clench::SimError> {
    sim.refresh()?;
    let model = sim.model();
    let item = |TendonLine { tendon, ends }| {
        let [from, to] = ends;
        let mut item = item_of(model, model.visuals.tendons[tendon]);
        let radius = model.visuals.tendon_width[tendon] as f32;
        let along = [0, 1, 2].map(|k| 0.5 * (to[k] - from[k]));
        let half = along.iter().map(|x| x * x).sum::<f32>().sqrt();
        let ahead = along.map(|x| x / half.max(1e-9));
        // Any direction that is not parallel to the tendon.
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
        let middle = [0, 1, 2].map(|k| 0.5 * (to[k] + from[k]));
        item.pose = [
            column(side, radius, 0.0),
            column(cross(ahead, side), radius, 0.0),
            column(ahead, half, 0.0),
            column(middle, 1.0, 1.0),
        ];
        item
    };
    Ok(sim.tendon_lines().into_iter().map(item).collect())
}
