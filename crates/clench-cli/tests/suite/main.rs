//! Tests that run the program, in one program. Those outside this folder need a GPU.

mod arguments;
mod bounds;
mod killed;
mod messages;
mod profile;
mod program;
mod quality;
mod recordings;
mod states;
