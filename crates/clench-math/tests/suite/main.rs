//! Tests of numbers through the crate's public API, in one program so that their generic code is compiled once.

mod chain;
mod dual;
mod elementary;
mod geometry;
mod kernel;
mod lanes;
mod rotation;
mod spatial;
mod support;
