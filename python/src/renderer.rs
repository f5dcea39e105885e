//! The renderers of a model.

#[cfg(feature = "render")]
pub(crate) use clench_render::{RayCaster, RenderError, Renderer};
#[cfg(feature = "render")]
use std::sync::Arc;

/// The renderers of a model; none before the first picture.
#[cfg(feature = "render")]
#[derive(Default)]
pub(crate) struct Renderers {
    pub(crate) device: OwnRenderer,
    pub(crate) rays: Option<Arc<RayCaster>>,
}

/// The renderer of a process. A process that it forks has no device: a picture, and even a release, would wait forever.
#[cfg(feature = "render")]
#[derive(Default)]
pub(crate) struct OwnRenderer {
    renderer: Option<Renderer>,
    process: u32,
}

#[cfg(feature = "render")]
impl OwnRenderer {
    /// Returns the renderer of this process, which the first call creates.
    pub(crate) fn get(&mut self, model: &Arc<clench::Model>) -> Result<&mut Renderer, RenderError> {
        self.forget_lost();
        self.process = std::process::id();
        match &mut self.renderer {
            Some(renderer) => Ok(renderer),
            none => Ok(none.insert(Renderer::new(model)?)),
        }
    }

    /// Forgets the renderer of another process.
    fn forget_lost(&mut self) {
        if self.process != std::process::id() {
            std::mem::forget(self.renderer.take());
        }
    }
}

#[cfg(feature = "render")]
impl Drop for OwnRenderer {
    fn drop(&mut self) {
        self.forget_lost();
    }
}

/// No renderers, without the `render` feature.
#[cfg(not(feature = "render"))]
#[derive(Default)]
pub(crate) struct Renderers;
