//! Tests of the solver through its public face: one program, so that its generic code is compiled once for all of them. `allocation.rs`
//! beside this folder counts what is allocated and needs a program of its own; `clarabel` holds solutions to another solver.

mod common;
mod input;
mod islands;
mod lanes;
mod loose;
mod noslip;
mod optimality;
mod single_precision;
mod threads;
