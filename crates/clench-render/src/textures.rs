//! The textures of a model on the GPU, with mipmaps.

use crate::device::Gpu;
use crate::passes::Passes;
use clench::Model;
use clench::rigid::model::{Pixels, TextureKind};
use clench_view::surfaces;
use wgpu::util::{DeviceExt, TextureDataOrder};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Extent3d, Sampler,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor, TextureViewDimension,
};

/// The number of sides of a cube.
const SIDES: usize = 6;

/// The textures in use, and a blank one.
pub(crate) struct Textures {
    /// The textures by their index in the model; `None` if unused.
    of_model: Vec<Option<BindGroup>>,
    blank: BindGroup,
}

impl Textures {
    /// Uploads the textures of geoms and sites.
    pub(crate) fn new(gpu: &Gpu, passes: &Passes, model: &Model) -> Self {
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let white = Pixels {
            width: 1,
            height: 1,
            rgb: vec![255; 3],
        };
        let blank = plane(gpu, &white);
        let blank_cube = cube(gpu, &white);
        let visuals = &model.visuals;
        let mut of_model = vec![None; visuals.textures.len()];
        for &appearance in visuals.geoms.iter().chain(&visuals.sites) {
            let Some(index) = surfaces::texture(model, appearance) else {
                continue;
            };
            of_model[index].get_or_insert_with(|| {
                let texture = &visuals.textures[index];
                let pixels = texture.pixels();
                match texture.kind {
                    TextureKind::Plane => {
                        group(gpu, passes, &sampler, &plane(gpu, &pixels), &blank_cube)
                    }
                    _ => group(gpu, passes, &sampler, &blank, &cube(gpu, &pixels)),
                }
            });
        }
        Textures {
            of_model,
            blank: group(gpu, passes, &sampler, &blank, &blank_cube),
        }
    }

    /// Returns the texture of an element; `None` for none.
    pub(crate) fn of(&self, texture: Option<usize>) -> &BindGroup {
        let found = texture.and_then(|index| self.of_model.get(index)?.as_ref());
        found.unwrap_or(&self.blank)
    }
}

fn group(
    gpu: &Gpu,
    passes: &Passes,
    sampler: &Sampler,
    plane: &TextureView,
    cube: &TextureView,
) -> BindGroup {
    let resources = [
        BindingResource::TextureView(plane),
        BindingResource::TextureView(cube),
        BindingResource::Sampler(sampler),
    ];
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&BindGroupDescriptor {
        label: Some("texture"),
        layout: &passes.texture,
        entries: &entries,
    })
}

fn plane(gpu: &Gpu, pixels: &Pixels) -> TextureView {
    upload(gpu, [pixels.width, pixels.height], &[&pixels.rgb])
}

/// Creates a cube from six squares below each other, or one for all sides.
fn cube(gpu: &Gpu, pixels: &Pixels) -> TextureView {
    let width = pixels.width;
    let square = 3 * width * width;
    let side = |side: usize| match pixels.height == SIDES * width {
        true => &pixels.rgb[side * square..(side + 1) * square],
        false => &pixels.rgb[..square],
    };
    upload(gpu, [width; 2], &std::array::from_fn::<_, SIDES, _>(side))
}

/// Uploads images of one size, with mipmaps. An image that is too large for the device is reduced.
fn upload(gpu: &Gpu, size: [usize; 2], layers: &[&[u8]]) -> TextureView {
    let most = gpu.device.limits().max_texture_dimension_2d as usize;
    let mut first = size;
    let mut data = Vec::new();
    for rgb in layers {
        let mut level = Level::new(size, rgb);
        while level.size.iter().any(|&side| side > most) {
            level = level.half();
        }
        first = level.size;
        data.extend(&level.rgba);
        while level.size != [1; 2] {
            level = level.half();
            data.extend(&level.rgba);
        }
    }
    let [width, height] = first.map(|side| side as u32);
    let described = TextureDescriptor {
        label: None,
        size: Extent3d {
            width,
            height,
            depth_or_array_layers: layers.len() as u32,
        },
        mip_level_count: width.max(height).ilog2() + 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba8UnormSrgb,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = TextureDataOrder::LayerMajor;
    let made = (gpu.device).create_texture_with_data(&gpu.queue, &described, order, &data);
    let dimension = match layers.len() {
        SIDES => TextureViewDimension::Cube,
        _ => TextureViewDimension::D2,
    };
    made.create_view(&TextureViewDescriptor {
        dimension: Some(dimension),
        ..TextureViewDescriptor::default()
    })
}

/// A mipmap level of an image.
struct Level {
    size: [usize; 2],
    rgba: Vec<u8>,
}

impl Level {
    fn new(size: [usize; 2], rgb: &[u8]) -> Self {
        let pixels = rgb.as_chunks::<3>().0.iter();
        Level {
            size,
            rgba: pixels.flat_map(|&[r, g, b]| [r, g, b, 255]).collect(),
        }
    }

    /// Returns the next level: each pixel is the mean of four, or of two at the end of an odd side.
    fn half(&self) -> Self {
        let [width, height] = self.size;
        let size = self.size.map(|side| (side / 2).max(1));
        let pixels = self.rgba.as_chunks::<4>().0;
        let mut rgba = Vec::with_capacity(4 * size[0] * size[1]);
        for row in 0..size[1] {
            let rows = [2 * row, (2 * row + 1).min(height - 1)];
            for column in 0..size[0] {
                let columns = [2 * column, (2 * column + 1).min(width - 1)];
                let four = rows.map(|r| columns.map(|c| pixels[r * width + c]));
                let mean = |k: usize| {
                    let sum: u32 = four.as_flattened().iter().map(|p| u32::from(p[k])).sum();
                    ((sum + 2) / 4) as u8
                };
                rgba.extend([0, 1, 2, 3].map(mean));
            }
        }
        Level { size, rgba }
    }
}
