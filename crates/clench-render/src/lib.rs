//! Images of simulations, drawn without a window: on any GPU, or by Mesa on the CPU.
//!
//! A [`Renderer`] stores the shapes of a model on the device and draws an [`Image`] of a simulation from a [`View`]:
//! colours, and optionally distances and the visible geoms. [`Pictures`] draws many simulations, several in a dispatch.
//! A [`RayCaster`] finds the same distances and geoms without a device. The module `triangles` creates the shapes of
//! geoms, [`camera`] the views.
//!
//! This crate contains no physics and writes no files.

#![deny(unreachable_pub)]

pub mod camera;
mod canvas;
mod device;
mod dispatch;
mod image;
mod items;
mod light;
mod looks;
mod passes;
mod rays;
mod renderer;
mod scene;
mod shapes;
mod simplify;
mod textures;
mod triangles;

pub use camera::{FreeCamera, View};
pub use device::{RenderError, device_name};
pub use image::{Image, Planes};
pub use looks::{LookField, Looks};
pub use rays::{RayCaster, RayPictures};
pub use renderer::{Picture, Pictures, Renderer};
