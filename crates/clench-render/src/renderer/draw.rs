//! The passes of an image.

use super::{Draw, Renderer};
use crate::canvas::Canvas;
use crate::light::SKY;
use clench::rigid::model::Appearance;
use wgpu::{
    BindGroup, Color, CommandEncoder, LoadOp, Operations, RenderPass, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp, TextureView,
};

impl Renderer {
    /// Draws the shadow map from the sun or from the model's light that casts the shadow.
    pub fn shade(&self, encoder: &mut CommandEncoder, draw: &Draw) {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("shadow"),
            depth_stencil_attachment: Some(depth_attachment(&self.shadow)),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, draw);
        pass.set_pipeline(&self.passes.shadow);
        // Planes are excluded: they shade nothing visible and would shade themselves. So are sites, which are marks.
        let plane = clench::collide::ShapeKind::Plane;
        let casts = |&&k: &&usize| (self.model.geoms.get(k)).is_some_and(|geom| geom.kind != plane);
        let casting = draw.opaque.iter().filter(casts);
        casting.for_each(|&g| self.draw_one(&mut pass, g));
        self.draw_strings(&mut pass, draw);
    }

    /// Draws the colours.
    pub fn paint(&self, encoder: &mut CommandEncoder, draw: &Draw, canvas: &Canvas) {
        let [r, g, b] = SKY.map(|x| f64::from(x).powf(2.2));
        let resolved = canvas.picture.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &canvas.samples,
                depth_slice: None,
                resolve_target: Some(&resolved),
                ops: Operations {
                    load: LoadOp::Clear(Color { r, g, b, a: 1.0 }),
                    store: StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(depth_attachment(&canvas.samples_depth)),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, draw);
        pass.set_bind_group(1, &self.light, &[]);
        pass.set_pipeline(&self.passes.opaque);
        for &k in draw.opaque {
            pass.set_bind_group(2, self.texture_of(k), &[]);
            self.draw_one(&mut pass, k);
        }
        pass.set_bind_group(2, self.textures.of(&self.model, Appearance::default()), &[]);
        self.draw_strings(&mut pass, draw);
        pass.set_pipeline(&self.passes.transparent);
        for &k in draw.transparent {
            pass.set_bind_group(2, self.texture_of(k), &[]);
            self.draw_one(&mut pass, k);
        }
    }

    /// Draws distances and geom indices.
    pub fn measure(&self, encoder: &mut CommandEncoder, draw: &Draw, canvas: &Canvas) {
        let views = [&canvas.geoms, &canvas.distances].map(|t| t.create_view(&Default::default()));
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
                attachment(&views[0], -1.0),
                attachment(&views[1], f64::INFINITY),
            ],
            depth_stencil_attachment: Some(depth_attachment(&canvas.depth)),
            ..RenderPassDescriptor::default()
        });
        self.begin(&mut pass, draw);
        pass.set_pipeline(&self.passes.facts);
        let all = draw.opaque.iter().chain(draw.transparent);
        let geoms = all.filter(|&&k| k < self.model.geoms.len());
        geoms.for_each(|&g| self.draw_one(&mut pass, g));
        self.draw_strings(&mut pass, draw);
    }

    fn begin(&self, pass: &mut RenderPass, draw: &Draw) {
        pass.set_bind_group(0, draw.scene, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
    }

    /// Draws a geom or, with an index after those of geoms, a site.
    fn draw_one(&self, pass: &mut RenderPass, item: usize) {
        pass.draw(self.shapes[item].clone(), item as u32..item as u32 + 1);
    }

    fn texture_of(&self, item: usize) -> &BindGroup {
        let visuals = &self.model.visuals;
        let all = visuals.geoms.iter().chain(&visuals.sites);
        let appearance = all.copied().nth(item).unwrap_or_default();
        self.textures.of(&self.model, appearance)
    }

    fn draw_strings(&self, pass: &mut RenderPass, draw: &Draw) {
        let strings = draw.strings.start as u32..draw.strings.end as u32;
        if let Some(shape) = self.shapes.last().filter(|_| !strings.is_empty()) {
            pass.draw(shape.clone(), strings);
        }
    }
}

fn depth_attachment(view: &TextureView) -> RenderPassDepthStencilAttachment<'_> {
    RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(Operations {
            load: LoadOp::Clear(0.0),
            store: StoreOp::Store,
        }),
        stencil_ops: None,
    }
}
