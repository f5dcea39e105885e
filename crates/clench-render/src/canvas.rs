//! The textures that an image is drawn into, and reading their pixels.

use crate::device::Gpu;
use crate::passes::{DEPTH, DISTANCES, GEOMS, PICTURE, SAMPLES};
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, Extent3d, Texture, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureView,
};

/// The alignment of the rows of a copy, bytes.
const ROW: u32 = 256;

/// The textures of one image size.
pub struct Canvas {
    pub size: [u32; 2],
    pub samples: TextureView,
    pub picture: Texture,
    pub samples_depth: TextureView,
    pub geoms: Texture,
    pub distances: Texture,
    pub depth: TextureView,
}

impl Canvas {
    /// Creates the textures of an image size.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let view =
            |format, samples| texture(gpu, size, format, samples).create_view(&Default::default());
        Canvas {
            size,
            samples: view(PICTURE, SAMPLES),
            picture: texture(gpu, size, PICTURE, 1),
            samples_depth: view(DEPTH, SAMPLES),
            geoms: texture(gpu, size, GEOMS, 1),
            distances: texture(gpu, size, DISTANCES, 1),
            depth: view(DEPTH, 1),
        }
    }
}

/// Copies a texture to a readable buffer.
pub(crate) fn copy(gpu: &Gpu, encoder: &mut CommandEncoder, from: &Texture) -> Buffer {
    let size = from.size();
    let row = (4 * size.width).next_multiple_of(ROW);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pixels"),
        size: u64::from(row) * u64::from(size.height),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    encoder.copy_texture_to_buffer(
        from.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        size,
    );
    buffer
}

/// Returns the pixels of a copy.
pub(crate) fn read(copy: &Buffer, [width, _]: [u32; 2]) -> Vec<[u8; 4]> {
    let row = (4 * width).next_multiple_of(ROW) as usize;
    let Ok(bytes) = copy.get_mapped_range(..) else {
        return Vec::new();
    };
    let rows = bytes.chunks_exact(row);
    rows.flat_map(|row| row[..4 * width as usize].as_chunks().0)
        .copied()
        .collect()
}

/// Creates a render target; with one sample per pixel it can also be read and sampled.
pub(crate) fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: TextureFormat,
    samples: u32,
) -> Texture {
    let kept = match samples {
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
        usage: TextureUsages::RENDER_ATTACHMENT | kept,
        view_formats: &[],
    })
}
