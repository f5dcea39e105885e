//! Pictures of simulations, drawn without a window: on any graphics card, or by Mesa on the processor.
//!
//! A [`Renderer`] has the shapes of a model on the device and draws an [`Image`] of a simulation from a [`View`]: colours, and
//! where wanted distances and the geoms that are seen. The module `triangles` makes shapes of geoms, [`camera`] the way of looking.
//!
//! No physics here, and no files: what is done with a picture is its user's business.

#![deny(unreachable_pub)]

pub mod camera;
mod canvas;
mod device;
mod image;
mod items;
mod light;
mod passes;
mod renderer;
mod textures;
mod triangles;

pub use camera::{FreeCamera, View};
pub use device::RenderError;
pub use image::Image;
pub use renderer::{Picture, Renderer};
