//! Tests of the device through the crate's public face: one program, so that its generic code is compiled once for all of them, and
//! kernels of several models are compiled side by side.

mod batch;
mod common;
mod dm_control;
mod double;
mod gymnasium;
mod large;
mod outputs;
mod random;
mod refusals;
mod solver;
mod stages;
mod steps;
