//! Tests of the device through the crate's public API, in one program so that its generic code is compiled once, and
//! kernels of several models are compiled in parallel.

mod autoreset;
mod batch;
mod common;
mod discrete;
mod dm_control;
mod double;
mod gymnasium;
mod histories;
mod large;
mod outputs;
mod random;
mod refusals;
mod sizes;
mod sleep_combined;
mod sleeping;
mod slots;
mod solver;
mod stages;
mod steps;
mod stiction;
mod touch;
