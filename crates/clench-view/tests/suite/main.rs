//! Tests of the server and its messages, in one program.

mod deltas;
mod passive;
mod player;
mod pushes;
mod recordings;
mod server;
