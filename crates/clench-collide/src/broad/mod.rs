//! Broad phase: finds the pairs of shapes that may touch.
//!
//! [`Bound`] encloses a shape in a sphere and an axis-aligned box, [`near`] compares two of them, and [`BroadPhase`]
//! finds the near pairs of a scene of many shapes.

mod aabb;
mod bound;
mod grid;
mod phase;
mod static_tree;

pub use bound::{Bound, allowance, near};
pub use phase::{BroadPhase, Mobility};
