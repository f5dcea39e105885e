//! The renderers of a model.

#[cfg(feature = "render")]
pub(crate) use clench_render::{RayCaster, Renderer};

/// The renderers of a model; none before the first picture.
#[cfg(feature = "render")]
#[derive(Default)]
pub(crate) struct Renderers {
    pub(crate) device: Option<Renderer>,
    pub(crate) rays: Option<std::sync::Arc<RayCaster>>,
}

/// No renderers, without the `render` feature.
#[cfg(not(feature = "render"))]
#[derive(Default)]
pub(crate) struct Renderers;
