//! Tests that run the program: one program of their own. Those beside this folder need a graphics device.

mod bounds;
mod killed;
mod messages;
mod profile;
mod program;
mod quality;
mod recordings;
