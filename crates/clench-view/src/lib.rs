//! The viewer: a page in the browser that shows a simulation and lets users interact with it.
//!
//! [`scene`] describes the elements to draw, [`surfaces`] their textures, [`frame`] their poses and the forces;
//! viewers, recordings and videos share them. [`Server`] sends a page, a scene and frames to browsers, and passes their
//! [`Command`]s to the code that steps the simulation: [`Player`], which steps it in real time, or the user's own loop
//! with a [`PassiveViewer`]. [`interaction`] implements the commands for both. The source of the page is in `web/`.
//!
//! This crate contains no physics and does not define the layout of the page.

#![deny(unreachable_pub)]

pub mod command;
pub mod delta;
mod drag;
pub mod frame;
mod handshake;
mod http;
pub mod interaction;
pub mod marks;
pub mod mcap;
pub mod page;
mod passive;
mod player;
mod recording;
pub mod scene;
mod server;
mod shared;
mod socket;
pub mod stages;
pub mod surfaces;
pub mod viewed;

pub use command::Command;
pub use drag::Drag;
pub use marks::{Mark, MarkShape, Marks};
pub use mcap::McapRecorder;
pub use page::Page;
pub use passive::PassiveViewer;
pub use player::Player;
pub use recording::{ReadError, RecordError, Recording};
pub use scene::Scene;
pub use server::{ServeError, Server, ServerOptions};
pub use viewed::{Stepped, Viewed};
