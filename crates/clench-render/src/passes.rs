//! The three passes: the shadow map, the colours, and the distances with geom indices.

use crate::items::Surface;
use crate::triangles::Vertex;
use std::sync::OnceLock;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BlendState,
    BufferBindingType, ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, Device,
    Face, FragmentState, MultisampleState, PipelineCompilationOptions, PipelineLayoutDescriptor,
    PrimitiveState, RenderPipeline, RenderPipelineDescriptor, SamplerBindingType, ShaderModule,
    ShaderStages, TextureFormat, TextureSampleType, TextureViewDimension, VertexBufferLayout,
    VertexState, VertexStepMode,
};

/// The colours of a screen. The shader converts linear values once a pixel; a device would do it for every sample.
pub(crate) const PICTURE: TextureFormat = TextureFormat::Rgba8Unorm;
pub(crate) const GEOMS: TextureFormat = TextureFormat::R32Sint;
pub(crate) const DISTANCES: TextureFormat = TextureFormat::R32Float;
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// The number of samples of a pixel.
pub(crate) const SAMPLES: u32 = 4;

/// The pipelines and their layouts. Pipelines are created when they are needed first: most models need few.
pub(crate) struct Passes {
    pub scene: BindGroupLayout,
    pub light: BindGroupLayout,
    pub texture: BindGroupLayout,
    module: ShaderModule,
    own_lights: bool,
    /// Those of each task, without and with culling.
    pipelines: [[OnceLock<RenderPipeline>; 2]; Task::COUNT],
}

/// The task of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Task {
    Shadow,
    Facts,
    Opaque(Surface),
    Transparent(Surface),
}

impl Task {
    const COUNT: usize = 2 + 2 * Surface::COUNT;

    fn index(self) -> usize {
        match self {
            Task::Shadow => 0,
            Task::Facts => 1,
            Task::Opaque(surface) => 2 + surface as usize,
            Task::Transparent(surface) => 2 + Surface::COUNT + surface as usize,
        }
    }
}

/// The settings that differ between pipelines.
struct PipelineOptions<'a> {
    vertex: &'a str,
    fragment: Option<&'a str>,
    targets: &'a [Option<ColorTargetState>],
    layouts: &'a [Option<&'a BindGroupLayout>],
    samples: u32,
    writes_depth: bool,
    culls: bool,
    constants: &'a [(&'a str, f64)],
}

impl Passes {
    /// Creates the layouts for models with their own lights, or for daylight.
    pub(crate) fn new(device: &Device, own_lights: bool) -> Self {
        Passes {
            scene: scene_layout(device),
            light: light_layout(device),
            texture: texture_layout(device),
            module: device.create_shader_module(wgpu::include_wgsl!("shader.wgsl")),
            own_lights,
            pipelines: Default::default(),
        }
    }

    /// Returns the pipeline of a task, which omits the back sides of triangles if `culls`.
    pub(crate) fn pipeline(&self, device: &Device, task: Task, culls: bool) -> &RenderPipeline {
        self.pipelines[task.index()][usize::from(culls)].get_or_init(|| match task {
            Task::Shadow => self.make_facts(device, culls, None),
            Task::Facts => self.make_facts(device, culls, Some("facts")),
            Task::Opaque(surface) => self.make_picture(device, culls, surface, None),
            Task::Transparent(surface) => {
                self.make_picture(device, culls, surface, Some(BlendState::ALPHA_BLENDING))
            }
        })
    }

    fn make_facts(&self, device: &Device, culls: bool, fragment: Option<&str>) -> RenderPipeline {
        let targets = [target(GEOMS, None), target(DISTANCES, None)];
        let options = PipelineOptions {
            vertex: fragment.map_or("shadow_corner", |_| "corner"),
            fragment,
            targets: fragment.map_or(&[], |_| &targets),
            layouts: &[Some(&self.scene)],
            samples: 1,
            writes_depth: true,
            culls,
            constants: &[],
        };
        make(device, &self.module, &options)
    }

    fn make_picture(
        &self,
        device: &Device,
        culls: bool,
        surface: Surface,
        blend: Option<BlendState>,
    ) -> RenderPipeline {
        let options = PipelineOptions {
            vertex: "corner",
            fragment: Some("picture"),
            targets: &[target(PICTURE, blend)],
            layouts: &[Some(&self.scene), Some(&self.light), Some(&self.texture)],
            samples: SAMPLES,
            writes_depth: blend.is_none(),
            culls,
            constants: &[
                ("own_lights", f64::from(u8::from(self.own_lights))),
                ("kind", f64::from(surface as u8)),
            ],
        };
        make(device, &self.module, &options)
    }
}

fn target(format: TextureFormat, blend: Option<BlendState>) -> Option<ColorTargetState> {
    Some(ColorTargetState {
        format,
        blend,
        write_mask: ColorWrites::ALL,
    })
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

fn make(device: &Device, module: &ShaderModule, options: &PipelineOptions) -> RenderPipeline {
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
        primitive: PrimitiveState {
            cull_mode: options.culls.then_some(Face::Back),
            ..PrimitiveState::default()
        },
        depth_stencil: Some(DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(options.writes_depth),
            // Of two items at one depth the later is drawn, as in MuJoCo.
            depth_compare: Some(CompareFunction::GreaterEqual),
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
