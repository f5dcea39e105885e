//! Broad phase: which pairs of shapes are near enough to be worth asking about.
//!
//! [`Bound`] holds a shape in a ball and in a box along the coordinate axes, [`near`] compares two of them, and [`BroadPhase`] finds the
//! near pairs of a scene of many shapes.

mod aabb;
mod bound;
mod grid;
mod phase;
mod static_tree;

pub use bound::{Bound, allowance, near};
pub use phase::{BroadPhase, Mobility};
