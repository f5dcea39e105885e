//! Compares the derivatives of steps with central differences.

mod common;
mod differences;
mod error_bounds;
mod jvp;
mod recursion;
mod rollout;
mod state;
mod steps;
