//! The textures that pictures are drawn into, and reading their pixels.
//!
//! Each picture of a dispatch has its own texture. Pictures side by side in one texture would differ in the last bits
//! from a picture alone, because devices round positions in the texture. Layers of one texture would do, but Mesa's
//! software device resolves samples to the first layer only.

use crate::device::Gpu;
use crate::image::Planes;
use crate::light::light_group;
use crate::passes::{DEPTH, DISTANCES, GEOMS, PICTURE, Passes, SAMPLES};
use wgpu::{
    BindGroup, Buffer, BufferUsages, CommandEncoder, Extent3d, MapRangeError, Texture,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};

/// The alignment of the rows of a copy, bytes.
const ROW: u32 = 256;
/// The number of dispatches under way: the device draws one while the processor prepares the next.
pub(crate) const FLIGHTS: usize = 2;
/// The memory of the pictures of a canvas and of their shadow maps, bytes.
const BUDGET: u64 = 96 << 20;
/// The maximum number of pictures of a dispatch.
const MAX_PICTURES: u64 = 32;

/// The kind of pictures that a canvas holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Form {
    pub size: [u32; 2],
    pub colors: bool,
    pub facts: bool,
}

/// The textures of pictures of one form, and the buffers that they are read from.
pub(crate) struct Canvas {
    pub form: Form,
    /// The number of pictures of a dispatch.
    pub pictures: u32,
    pub colors: Option<Colors>,
    pub facts: Option<Facts>,
    copies: [Buffer; FLIGHTS],
}

/// The textures of colours, with the shadow maps of the environments.
pub(crate) struct Colors {
    pub samples: TextureView,
    pub samples_depth: TextureView,
    pub pictures: Vec<Target>,
    pub shadows: Vec<TextureView>,
    pub lights: Vec<BindGroup>,
}

/// The textures of distances and geom indices.
pub(crate) struct Facts {
    pub depth: TextureView,
    pub geoms: Vec<Target>,
    pub distances: Vec<Target>,
}

/// A texture that is drawn into and read.
pub(crate) struct Target {
    texture: Texture,
    pub view: TextureView,
}

impl Form {
    /// Returns the number of pixels of a side of the shadow maps: a few of its texels fall on a pixel.
    pub(crate) fn shadow(&self) -> u32 {
        (4 * self.size[0].max(self.size[1]))
            .next_power_of_two()
            .clamp(256, 2048)
    }

    /// Returns the number of textures that are read.
    fn planes(&self) -> u32 {
        u32::from(self.colors) + 2 * u32::from(self.facts)
    }

    /// Returns the bytes of a row of a copy.
    fn row(&self) -> u32 {
        (4 * self.size[0]).next_multiple_of(ROW)
    }

    /// Returns the bytes of a picture in a copy.
    fn picture(&self) -> u64 {
        u64::from(self.row()) * u64::from(self.size[1])
    }

    /// Returns the number of pictures of a dispatch of a call that requests `requested` pictures.
    pub(crate) fn pictures(&self, requested: usize) -> u32 {
        let shadow = u64::from(self.colors) * 4 * u64::from(self.shadow()).pow(2);
        let each = u64::from(self.planes()) * self.picture() + shadow;
        let max_pictures = (BUDGET / each.max(1)).clamp(1, MAX_PICTURES);
        (requested.max(1) as u64)
            .next_power_of_two()
            .min(max_pictures) as u32
    }
}

impl Canvas {
    /// Creates the textures of a form.
    pub(crate) fn new(gpu: &Gpu, passes: &Passes, form: Form, pictures: u32) -> Self {
        let size = form.size;
        let targets = |format| {
            (0..pictures)
                .map(|_| Target::new(gpu, size, format))
                .collect()
        };
        let single =
            |format, samples| texture(gpu, size, format, samples).create_view(&Default::default());
        let colors = form.colors.then(|| {
            let shadow = |_| Target::new(gpu, [form.shadow(); 2], DEPTH).view;
            let shadows = Vec::from_iter((0..pictures).map(shadow));
            Colors {
                samples: single(PICTURE, SAMPLES),
                samples_depth: single(DEPTH, SAMPLES),
                pictures: targets(PICTURE),
                lights: (shadows.iter().map(|map| light_group(gpu, passes, map))).collect(),
                shadows,
            }
        });
        let facts = form.facts.then(|| Facts {
            depth: single(DEPTH, 1),
            geoms: targets(GEOMS),
            distances: targets(DISTANCES),
        });
        let copy = |_| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pixels"),
                size: u64::from(form.planes()) * u64::from(pictures) * form.picture(),
                usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        };
        Canvas {
            form,
            pictures,
            colors,
            facts,
            copies: std::array::from_fn(copy),
        }
    }

    /// Returns the buffer that the pictures of a dispatch are read from.
    pub(crate) fn copy(&self, flight: usize) -> &Buffer {
        &self.copies[flight % FLIGHTS]
    }

    /// Copies the first `count` pictures to a readable buffer: all colours, then all geom indices and all distances.
    pub(crate) fn store(&self, encoder: &mut CommandEncoder, flight: usize, count: usize) {
        let colors = self.colors.iter().map(|colors| &colors.pictures);
        let facts = self.facts.iter();
        let facts = facts.flat_map(|facts| [&facts.geoms, &facts.distances]);
        for (plane, targets) in (0..).zip(colors.chain(facts)) {
            let first = plane * u64::from(self.pictures);
            for (index, target) in (first..).zip(&targets[..count]) {
                let size = target.texture.size();
                encoder.copy_texture_to_buffer(
                    target.texture.as_image_copy(),
                    wgpu::TexelCopyBufferInfo {
                        buffer: self.copy(flight),
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: index * self.form.picture(),
                            bytes_per_row: Some(self.form.row()),
                            rows_per_image: None,
                        },
                    },
                    size,
                );
            }
        }
    }

    /// Writes the pictures of a dispatch into memory, at the indices `slots`.
    pub(crate) fn read(
        &self,
        flight: usize,
        slots: &[usize],
        out: &mut Planes,
    ) -> Result<(), MapRangeError> {
        let bytes = self.copy(flight).get_mapped_range(..)?;
        let (row, width) = (self.form.row() as usize, self.form.size[0] as usize);
        let pixels = width * self.form.size[1] as usize;
        let picture = self.form.picture() as usize;
        let rows = |plane: usize, index: usize| {
            let start = (plane * self.pictures as usize + index) * picture;
            let rows = bytes[start..start + picture].chunks_exact(row);
            rows.flat_map(|row| row[..4 * width].as_chunks::<4>().0)
        };
        let facts = usize::from(self.form.colors);
        for (index, &slot) in slots.iter().enumerate() {
            let (start, end) = (slot * pixels, (slot + 1) * pixels);
            if let Some(to) = out.rgb.get_mut(3 * start..3 * end) {
                let to = to.as_chunks_mut::<3>().0.iter_mut();
                to.zip(rows(0, index))
                    .for_each(|(to, &[r, g, b, _])| *to = [r, g, b]);
            }
            if let Some(to) = out.geoms.get_mut(start..end) {
                (to.iter_mut().zip(rows(facts, index)))
                    .for_each(|(to, &bytes)| *to = i32::from_le_bytes(bytes));
            }
            if let Some(to) = out.depth.get_mut(start..end) {
                (to.iter_mut().zip(rows(facts + 1, index)))
                    .for_each(|(to, &bytes)| *to = f32::from_le_bytes(bytes));
            }
        }
        Ok(())
    }
}

impl Target {
    fn new(gpu: &Gpu, size: [u32; 2], format: TextureFormat) -> Self {
        let texture = texture(gpu, size, format, 1);
        Target {
            view: texture.create_view(&Default::default()),
            texture,
        }
    }
}

/// Creates a render target; with one sample per pixel it can also be read and sampled.
fn texture(gpu: &Gpu, [width, height]: [u32; 2], format: TextureFormat, samples: u32) -> Texture {
    let extra_usage = match samples {
        1 => TextureUsages::COPY_SRC | TextureUsages::TEXTURE_BINDING,
        _ => TextureUsages::empty(),
    };
    gpu.device.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: samples,
        dimension: TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | extra_usage,
        view_formats: &[],
    })
}
