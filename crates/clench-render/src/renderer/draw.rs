//! The passes of a dispatch.

use super::Renderer;
use crate::canvas::{Canvas, Colors, Facts};
use crate::dispatch::{Dispatch, Drawn, STRIDE, Shot};
use crate::items::Surface;
use crate::light::{SKY, Uniforms};
use crate::passes::Task;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, BufferBinding, BufferSize,
    BufferUsages, Color, CommandEncoder, LoadOp, Operations, RenderPass, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp, TextureView,
};
use zerocopy::IntoBytes;

impl Renderer {
    /// Encodes all passes: first all shadow maps and then all pictures, so that the device waits between them once.
    pub(super) fn encode(
        &self,
        encoder: &mut CommandEncoder,
        dispatch: &Dispatch,
        canvas: &Canvas,
    ) {
        let content = self.bind(dispatch);
        if let Some(colors) = &canvas.colors {
            for (shadow, map) in dispatch.shadows.iter().zip(&colors.shadows) {
                if let Some(casting) = &shadow.casting {
                    self.shade(encoder, (&content, shadow.shot), casting, map);
                }
            }
            for (index, shot) in dispatch.shots.iter().enumerate() {
                self.paint(encoder, (&content, index), shot, colors);
            }
        }
        if let Some(facts) = &canvas.facts {
            for (index, shot) in dispatch.shots.iter().enumerate() {
                self.measure(encoder, (&content, index), shot, facts);
            }
        }
    }

    /// Draws the shadow map from the sun or from the model's light that casts the shadow.
    fn shade(
        &self,
        encoder: &mut CommandEncoder,
        content: (&BindGroup, usize),
        casting: &[Drawn],
        map: &TextureView,
    ) {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("shadow"),
            depth_stencil_attachment: Some(depth_attachment(map, StoreOp::Store)),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, content);
        self.draw_items(&mut pass, casting, |_| Task::Shadow);
    }

    /// Draws the colours of a picture.
    fn paint(
        &self,
        encoder: &mut CommandEncoder,
        (content, index): (&BindGroup, usize),
        shot: &Shot,
        colors: &Colors,
    ) {
        let [r, g, b] = SKY.map(f64::from);
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &colors.samples,
                depth_slice: None,
                resolve_target: Some(&colors.pictures[index].view),
                ops: Operations {
                    load: LoadOp::Clear(Color { r, g, b, a: 1.0 }),
                    store: StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(depth_attachment(
                &colors.samples_depth,
                StoreOp::Discard,
            )),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, (content, index));
        pass.set_bind_group(1, &colors.lights[shot.environment], &[]);
        self.draw_items(&mut pass, &shot.opaque, Task::Opaque);
        self.draw_items(&mut pass, &shot.transparent, Task::Transparent);
    }

    /// Draws the distances and geom indices of a picture.
    fn measure(
        &self,
        encoder: &mut CommandEncoder,
        (content, index): (&BindGroup, usize),
        shot: &Shot,
        facts: &Facts,
    ) {
        let attachment = |view, nothing| {
            Some(RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(Color {
                        r: nothing,
                        ..Color::BLACK
                    }),
                    store: StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("facts"),
            color_attachments: &[
                attachment(&facts.geoms[index].view, -1.0),
                attachment(&facts.distances[index].view, f64::INFINITY),
            ],
            depth_stencil_attachment: Some(depth_attachment(&facts.depth, StoreOp::Discard)),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, (content, index));
        self.draw_items(&mut pass, &shot.facts, |_| Task::Facts);
    }

    /// Selects the parameters of a picture.
    fn begin(&self, pass: &mut RenderPass, (content, shot): (&BindGroup, usize)) {
        pass.set_bind_group(0, content, &[(shot * STRIDE) as u32]);
        pass.set_vertex_buffer(0, self.scene.shapes.corners.slice(..));
    }

    /// Draws items; `task` selects the pipeline of a surface.
    fn draw_items(&self, pass: &mut RenderPass, all: &[Drawn], task: impl Fn(Surface) -> Task) {
        let state = |drawn: &Drawn| (task(drawn.surface), drawn.culls, drawn.texture);
        for same in all.chunk_by(|a, b| state(a) == state(b)) {
            let Some((task, culls, texture)) = same.first().map(state) else {
                continue;
            };
            pass.set_pipeline(self.passes.pipeline(&self.gpu.device, task, culls));
            if matches!(task, Task::Opaque(_) | Task::Transparent(_)) {
                pass.set_bind_group(2, self.scene.textures.of(texture), &[]);
            }
            for drawn in same {
                pass.draw(drawn.vertices.clone(), drawn.items.clone());
            }
        }
    }

    /// Uploads the parameters of a dispatch, its items and its lights.
    fn bind(&self, dispatch: &Dispatch) -> BindGroup {
        let device = &self.gpu.device;
        // An empty buffer cannot be bound.
        let nothing = [0; 256];
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("scene"),
                contents: if contents.is_empty() {
                    &nothing
                } else {
                    contents
                },
                usage,
            })
        };
        let parameters = buffer(dispatch.parameters.as_bytes(), BufferUsages::UNIFORM);
        let items = buffer(dispatch.items.as_bytes(), BufferUsages::STORAGE);
        let lamps = buffer(dispatch.lamps.as_bytes(), BufferUsages::STORAGE);
        let one = BindingResource::Buffer(BufferBinding {
            buffer: &parameters,
            offset: 0,
            size: BufferSize::new(size_of::<Uniforms>() as u64),
        });
        let resources = [one, items.as_entire_binding(), lamps.as_entire_binding()];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&BindGroupDescriptor {
            label: Some("scene"),
            layout: &self.passes.scene,
            entries: &entries,
        })
    }
}

fn depth_attachment(view: &TextureView, store: StoreOp) -> RenderPassDepthStencilAttachment<'_> {
    RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(Operations {
            load: LoadOp::Clear(0.0),
            store,
        }),
        stencil_ops: None,
    }
}
