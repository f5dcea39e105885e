//! The three passes: the shadow map, the colours, and the distances with geom indices.

use crate::triangles::Vertex;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BlendState,
    BufferBindingType, ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, Device,
    FragmentState, MultisampleState, PipelineCompilationOptions, PipelineLayoutDescriptor,
    PrimitiveState, RenderPipeline, RenderPipelineDescriptor, SamplerBindingType, ShaderModule,
    ShaderStages, TextureFormat, TextureSampleType, TextureViewDimension, VertexBufferLayout,
    VertexState, VertexStepMode,
};

pub(crate) const PICTURE: TextureFormat = TextureFormat::Rgba8UnormSrgb;
pub(crate) const GEOMS: TextureFormat = TextureFormat::R32Sint;
pub(crate) const DISTANCES: TextureFormat = TextureFormat::R32Float;
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// The number of samples of a pixel.
pub(crate) const SAMPLES: u32 = 4;

/// The pipelines and their layouts.
pub(crate) struct Passes {
    pub scene: BindGroupLayout,
    pub light: BindGroupLayout,
    pub texture: BindGroupLayout,
    pub shadow: RenderPipeline,
    pub opaque: RenderPipeline,
    pub transparent: RenderPipeline,
    pub facts: RenderPipeline,
}

/// The settings that differ between pipelines.
struct PipelineOptions<'a> {
    vertex: &'a str,
    fragment: Option<&'a str>,
    targets: &'a [Option<ColorTargetState>],
    layouts: &'a [Option<&'a BindGroupLayout>],
    samples: u32,
    writes_depth: bool,
    constants: &'a [(&'a str, f64)],
}

impl Passes {
    /// Creates the pipelines for models with their own lights, or for daylight.
    pub(crate) fn new(device: &Device, own_lights: bool) -> Self {
        let constants = [("own_lights", f64::from(u8::from(own_lights)))];
        let module = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
        let scene = scene_layout(device);
        let light = light_layout(device);
        let target = |format, blend| {
            Some(ColorTargetState {
                format,
                blend,
                write_mask: ColorWrites::ALL,
            })
        };
        let texture = texture_layout(device);
        let all = [Some(&scene), Some(&light), Some(&texture)];
        let picture = |blend, writes_depth| {
            let options = PipelineOptions {
                vertex: "corner",
                fragment: Some("picture"),
                targets: &[target(PICTURE, blend)],
                layouts: &all,
                samples: SAMPLES,
                writes_depth,
                constants: &constants,
            };
            pipeline(device, &module, &options)
        };
        let facts = PipelineOptions {
            vertex: "corner",
            fragment: Some("facts"),
            targets: &[target(GEOMS, None), target(DISTANCES, None)],
            layouts: &all[..1],
            samples: 1,
            writes_depth: true,
            constants: &[],
        };
        let shadow = PipelineOptions {
            vertex: "shadow_corner",
            fragment: None,
            targets: &[],
            layouts: &all[..1],
            samples: 1,
            writes_depth: true,
            constants: &[],
        };
        Passes {
            shadow: pipeline(device, &module, &shadow),
            opaque: picture(None, true),
            transparent: picture(Some(BlendState::ALPHA_BLENDING), false),
            facts: pipeline(device, &module, &facts),
            scene,
            light,
            texture,
        }
    }
}

fn scene_layout(device: &Device) -> BindGroupLayout {
    // One buffer has the parameters of many pictures.
    let buffer = |binding, ty| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX_FRAGMENT,
        ty: BindingType::Buffer {
            ty,
            has_dynamic_offset: ty == BufferBindingType::Uniform,
            min_binding_size: None,
        },
        count: None,
    };
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some("scene"),
        entries: &[
            buffer(0, BufferBindingType::Uniform),
            buffer(1, BufferBindingType::Storage { read_only: true }),
            buffer(2, BufferBindingType::Storage { read_only: true }),
        ],
    })
}

fn light_layout(device: &Device) -> BindGroupLayout {
    let entry = |binding, ty| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let shadow = BindingType::Texture {
        sample_type: TextureSampleType::Depth,
        view_dimension: TextureViewDimension::D2,
        multisampled: false,
    };
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some("light"),
        entries: &[
            entry(0, shadow),
            entry(1, BindingType::Sampler(SamplerBindingType::Comparison)),
        ],
    })
}

/// Returns the layout of a plane texture, a cube texture and their sampler.
fn texture_layout(device: &Device) -> BindGroupLayout {
    let picture = |view_dimension| BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    };
    let kinds = [
        picture(TextureViewDimension::D2),
        picture(TextureViewDimension::Cube),
        BindingType::Sampler(SamplerBindingType::Filtering),
    ];
    let entry = |(binding, ty)| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some("texture"),
        entries: &(0..).zip(kinds).map(entry).collect::<Vec<_>>(),
    })
}

fn pipeline(device: &Device, module: &ShaderModule, options: &PipelineOptions) -> RenderPipeline {
    let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: options.layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: options.fragment,
        layout: Some(&layout),
        vertex: VertexState {
            module,
            entry_point: Some(options.vertex),
            compilation_options: Default::default(),
            buffers: &[Some(VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3],
            })],
        },
        // The vertices of mesh files have an arbitrary order, so both sides are drawn.
        primitive: PrimitiveState::default(),
        depth_stencil: Some(DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(options.writes_depth),
            depth_compare: Some(CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: MultisampleState {
            count: options.samples,
            ..MultisampleState::default()
        },
        fragment: options.fragment.map(|entry| FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: PipelineCompilationOptions {
                constants: options.constants,
                ..Default::default()
            },
            targets: options.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
