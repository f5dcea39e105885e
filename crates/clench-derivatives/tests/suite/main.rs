//! Compares the derivatives of steps with central differences.

mod common;
// Here, because this crate compiles pairs of shapes in dual numbers.
mod contact_points;
mod differences;
mod error_bounds;
mod jvp;
mod recursion;
mod rollout;
/// The random scenes of the tests of collision.
#[expect(dead_code, unused_imports, reason = "the tests here use a part")]
#[path = "../../../clench-collide/tests/suite/common/mod.rs"]
mod scenes;
mod state;
mod steps;
