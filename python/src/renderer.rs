//! The renderer of a model.

#[cfg(feature = "render")]
pub(crate) use clench_render::Renderer;

/// A renderer, which cannot exist without the `render` feature.
#[cfg(not(feature = "render"))]
pub(crate) enum Renderer {}
