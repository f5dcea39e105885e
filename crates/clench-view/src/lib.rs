//! The viewer: a page in the browser that shows a simulation and lets users touch it.
//!
//! [`scene`] says what there is to draw, [`surfaces`] how pictures lie on it, [`frame`] where it is now and what pushes on what;
//! viewers, recordings and films share them. [`Server`] hands a page, a scene and frames to browsers, and their [`Command`]s to whoever steps the simulation:
//! [`Player`], which steps it itself in real time, or a loop of the user's with a [`PassiveViewer`]. What commands do is the same
//! in both, in [`interaction`]. The page itself stands in `web/`.
//!
//! No physics here, and nothing about the layout of the page.

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
pub use recording::{RecordError, Recording};
pub use scene::Scene;
pub use server::{ServeError, Server, ServerOptions};
pub use viewed::{Stepped, Viewed};
