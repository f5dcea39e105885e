//! Tests of the solver through its public API, in one program so that its generic code is compiled once.
//! `allocation.rs` next to this folder counts allocations and needs its own program; `clarabel` compares solutions with
//! another solver.

mod common;
mod coulomb;
mod error_bounds;
mod input;
mod islands;
mod lanes;
mod loose;
mod noslip;
mod optimality;
mod single_precision;
mod threads;
