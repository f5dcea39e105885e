//! Tests of collision through the crate's public API, in one program so that its generic code is compiled once.

mod accuracy;
mod broad_phase;
mod closed_forms;
mod common;
mod cylinder_edges;
mod distance;
mod hulls;
mod invariance;
mod pair_memory;
mod patches;
mod protrusion;
mod ray_triangles;
mod rays;
mod resting;
mod rough_ground;
mod stability;
mod terrain;
mod trouble;
mod truth;
