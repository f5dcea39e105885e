//! The camera and light parameters of the shader, and the shadow of the sun or of a light.

use crate::camera::{CameraPose, Lens};
use crate::device::Gpu;
use crate::passes::Passes;
use clench::rigid::model::{Headlight, Light, LightKind};
use wgpu::{BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, TextureView};
use zerocopy::IntoBytes;

/// The distance of the near plane over the size of the model.
pub(crate) const NEAR: f32 = 0.003;
/// The size of an infinite plane over the size of the model.
pub(crate) const FAR: f32 = 300.0;
/// The radius of the shadowed region over the size of the model.
pub(crate) const REACH: f32 = 2.2;
/// The direction to the sun.
const TO_SUN: [f32; 3] = [0.150, -0.551, 0.821];
/// The background colour, as on the viewer's page.
pub(crate) const SKY: [f32; 3] = [0.875, 0.902, 0.933];

/// The parameters of an image in the shader.
#[repr(C)]
#[derive(Clone, Copy, IntoBytes, zerocopy::Immutable)]
pub(crate) struct Uniforms {
    camera: [[f32; 4]; 4],
    sun: [[f32; 4]; 4],
    eye: [f32; 4],
    ahead: [f32; 4],
    to_sun: [f32; 4],
    sky: [f32; 4],
    fog: [f32; 4],
    ambient: [f32; 4],
    head: [f32; 4],
    head_specular: [f32; 4],
}

/// A light as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, IntoBytes, zerocopy::Immutable)]
pub(crate) struct Lamp {
    place: [f32; 4],
    dir: [f32; 4],
    ambient: [f32; 4],
    diffuse: [f32; 4],
    specular: [f32; 4],
    attenuation: [f32; 4],
}

/// The lighting of an environment.
pub(crate) struct Lighting {
    pub lamps: Vec<Lamp>,
    /// The view of the sun, or of the model's light that casts the shadow.
    pub sun: CameraPose,
    /// True if there is a shadow.
    pub casts: bool,
    /// The sum of ambient light, the headlight's diffuse light and its highlights.
    head: [[f32; 3]; 3],
}

impl Lighting {
    /// Collects lights with the present position and direction of each. Only the first light with shadows
    /// casts one, over the region around `centre` within `reach`.
    pub(crate) fn new(
        (lights, headlight): (&[Light], &Headlight),
        places: &[[[f64; 3]; 2]],
        centre: [f32; 3],
        reach: f32,
    ) -> Self {
        let all = lights.iter().zip(places);
        let active: Vec<_> = all.filter(|(light, _)| light.properties.active).collect();
        let casting = active
            .iter()
            .position(|(light, _)| light.properties.castshadow);
        let head = [headlight.ambient, headlight.diffuse, headlight.specular]
            .map(|color| if headlight.active { color } else { [0.0; 3] });
        let sight = casting.map(|index| sight(active[index].0, active[index].1, centre, reach));
        Lighting {
            casts: sight.is_some() || lights.is_empty(),
            sun: sight.unwrap_or_else(|| far_away(centre, TO_SUN, reach)),
            lamps: (active.iter().enumerate())
                .map(|(index, &(light, place))| lamp(light, place, casting == Some(index)))
                .collect(),
            head: head.map(narrow),
        }
    }
}

fn narrow(v: [f64; 3]) -> [f32; 3] {
    v.map(|x| x as f32)
}

fn with([x, y, z]: [f32; 3], w: f32) -> [f32; 4] {
    [x, y, z, w]
}

fn lamp(light: &Light, place: &[[f64; 3]; 2], casts: bool) -> Lamp {
    let properties = &light.properties;
    let kind = match properties.kind {
        LightKind::Spot => 0.0,
        LightKind::Directional => 1.0,
        LightKind::Point => 2.0,
    };
    let [pos, dir] = place.map(narrow);
    Lamp {
        place: with(pos, kind),
        dir: with(dir, properties.cutoff.to_radians().cos() as f32),
        ambient: with(narrow(properties.ambient), properties.exponent as f32),
        diffuse: with(narrow(properties.diffuse), f32::from(u8::from(casts))),
        specular: with(narrow(properties.specular), 0.0),
        attenuation: with(narrow(properties.attenuation), 0.0),
    }
}

/// Returns the view of a light of the region around a centre.
fn sight(light: &Light, place: &[[f64; 3]; 2], centre: [f32; 3], reach: f32) -> CameraPose {
    let [pos, dir] = place.map(narrow);
    let away = [0, 1, 2].map(|k| centre[k] - pos[k]);
    match light.properties.kind {
        LightKind::Directional => far_away(centre, dir.map(|x| -x), reach),
        // A cone of a right angle or more would not fit into one view.
        LightKind::Spot => CameraPose {
            eye: pos,
            axes: axes(dir.map(|x| -x)),
            lens: Lens::central(light.properties.cutoff.clamp(1.0, 75.0).to_radians().tan() as f32),
            parallel: false,
        },
        LightKind::Point => CameraPose {
            eye: pos,
            axes: axes(unit(away.map(|x| -x))),
            lens: Lens::central((reach / length(away).max(1e-6)).clamp(0.1, 3.0)),
            parallel: false,
        },
    }
}

impl Uniforms {
    /// Creates the parameters of an image of a region of a size, m. The shadow map has `shadow` pixels a side, and the
    /// lights of the environment begin at the index `lamps`.
    pub(crate) fn new(
        camera: &CameraPose,
        aspect: f32,
        extent: f32,
        lighting: &Lighting,
        (shadow, lamps): (u32, usize),
    ) -> Self {
        let [near, far] = sun_planes(&lighting.sun, extent);
        let ahead = camera.axes[2].map(|x| -x);
        let reach = REACH * extent;
        let texel = 1.0 / shadow as f32;
        Uniforms {
            camera: camera.matrix(aspect, NEAR * extent, FAR * extent),
            sun: lighting.sun.matrix(1.0, near, far),
            eye: with(camera.eye, 1.0),
            ahead: with(ahead, f32::from(u8::from(camera.parallel))),
            to_sun: with(TO_SUN, texel),
            sky: with(SKY, 1.0),
            fog: [9.0 * extent, 60.0 * extent, 3.0 * reach * texel, 0.0],
            ambient: with(lighting.head[0], lighting.lamps.len() as f32),
            head: with(lighting.head[1], lamps as f32),
            head_specular: with(lighting.head[2], 0.0),
        }
    }
}

/// Returns the distances of the near and far planes of the view that casts the shadow, m.
fn sun_planes(sun: &CameraPose, extent: f32) -> [f32; 2] {
    match sun.parallel {
        true => [0.1 * REACH * extent, 6.0 * REACH * extent],
        false => [NEAR * extent, FAR * extent],
    }
}

/// Creates the bind group of the shadow map.
pub(crate) fn light_group(gpu: &Gpu, passes: &Passes, shadow: &TextureView) -> BindGroup {
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        compare: Some(wgpu::CompareFunction::GreaterEqual),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    });
    gpu.device.create_bind_group(&BindGroupDescriptor {
        label: Some("light"),
        layout: &passes.light,
        entries: &[
            BindGroupEntry {
                binding: 0,
                resource: BindingResource::TextureView(shadow),
            },
            BindGroupEntry {
                binding: 1,
                resource: BindingResource::Sampler(&sampler),
            },
        ],
    })
}

/// Returns the view of a distant light around a point; `to_light` is the direction to the light.
fn far_away(centre: [f32; 3], to_light: [f32; 3], reach: f32) -> CameraPose {
    CameraPose {
        eye: [0, 1, 2].map(|k| centre[k] + 3.0 * reach * to_light[k]),
        axes: axes(to_light),
        lens: Lens::central(reach),
        parallel: true,
    }
}

/// Returns the axes to the right, upwards and backwards.
fn axes(back: [f32; 3]) -> [[f32; 3]; 3] {
    let [x, y, z] = back;
    let flat = (x * x + y * y).sqrt();
    // For a vertical view any horizontal direction serves as the right.
    let right = match flat > 1e-6 {
        true => [-y / flat, x / flat, 0.0],
        false => [1.0, 0.0, 0.0],
    };
    let up = [
        y * right[2] - z * right[1],
        z * right[0] - x * right[2],
        x * right[1] - y * right[0],
    ];
    [right, up, back]
}

fn length(v: [f32; 3]) -> f32 {
    v.iter().map(|x| x * x).sum::<f32>().sqrt()
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    match length(v) {
        size if size > 0.0 => v.map(|x| x / size),
        _ => [0.0, 0.0, 1.0],
    }
}
