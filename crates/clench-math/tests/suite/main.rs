//! Tests of numbers through the crate's public face: one program, so that their generic code is compiled once for all of them.

mod chain;
mod elementary;
mod geometry;
mod kernel;
mod lanes;
mod rotation;
mod spatial;
mod support;
