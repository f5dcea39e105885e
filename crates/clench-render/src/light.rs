//! What the shader is told of the camera and the light, and the sun's shadow.

use crate::camera::Placed;
use crate::device::Gpu;
use crate::passes::Passes;
use wgpu::{BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, TextureView};
use zerocopy::IntoBytes;

/// Pixels of a side of the sun's shadow.
pub const SHADOW: u32 = 2048;
/// Nearest thing that is seen, over the size of the model.
const NEAR: f32 = 0.003;
/// How far a plane without end reaches, over the size of the model.
pub const FAR: f32 = 300.0;
/// Towards the sun.
const TO_SUN: [f32; 3] = [0.150, -0.551, 0.821];
/// Behind everything, as on the viewer's page.
pub const SKY: [f32; 3] = [0.875, 0.902, 0.933];

/// What the shader is told of a picture.
#[repr(C)]
#[derive(Clone, Copy, IntoBytes, zerocopy::Immutable)]
pub struct Uniforms {
    camera: [[f32; 4]; 4],
    sun: [[f32; 4]; 4],
    eye: [f32; 4],
    ahead: [f32; 4],
    to_sun: [f32; 4],
    sky: [f32; 4],
    fog: [f32; 4],
}

impl Uniforms {
    /// Of a picture of things of a size around a centre, m.
    pub fn new(camera: &Placed, aspect: f32, extent: f32, centre: [f32; 3]) -> Self {
        let far = FAR * extent;
        let ahead = camera.axes[2].map(|x| -x);
        let reach = 2.2 * extent;
        Uniforms {
            camera: camera.matrix(aspect, NEAR * extent, far),
            sun: sun_matrix(centre, reach),
            eye: [camera.eye[0], camera.eye[1], camera.eye[2], 1.0],
            ahead: [
                ahead[0],
                ahead[1],
                ahead[2],
                f32::from(u8::from(camera.parallel)),
            ],
            to_sun: [TO_SUN[0], TO_SUN[1], TO_SUN[2], 1.0 / SHADOW as f32],
            sky: [SKY[0], SKY[1], SKY[2], 1.0],
            fog: [
                9.0 * extent,
                60.0 * extent,
                3.0 * reach / SHADOW as f32,
                0.0,
            ],
        }
    }
}

/// What lights things: the sun's shadow.
pub fn light_group(gpu: &Gpu, passes: &Passes, shadow: &TextureView) -> BindGroup {
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

/// From the world to the picture that the sun sees around a point.
fn sun_matrix(centre: [f32; 3], reach: f32) -> [[f32; 4]; 4] {
    let [x, y, z] = TO_SUN;
    let flat = (x * x + y * y).sqrt();
    let right = [-y / flat, x / flat, 0.0];
    let up = [-z * x / flat, -z * y / flat, flat];
    let sun = Placed {
        eye: [0, 1, 2].map(|k| centre[k] + 3.0 * reach * TO_SUN[k]),
        axes: [right, up, TO_SUN],
        half: reach,
        parallel: true,
    };
    sun.matrix(1.0, 0.1 * reach, 6.0 * reach)
}
