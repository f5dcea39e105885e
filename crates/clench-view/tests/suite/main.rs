//! Tests of the server and of what it sends: one program.

mod deltas;
mod pushes;
mod server;
