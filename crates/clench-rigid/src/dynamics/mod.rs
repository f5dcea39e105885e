//! Smooth dynamics: everything of the equation of motion but constraints, one idea a file.
//!
//! ```text
//! M(q) a = τ,   τ = passive + actuation + applied − bias(q, v)
//! ```
//!
//! Spatial vectors of a kinematic tree are about the tree's centre of mass (`subtree_com` of its root), in world axes, as
//! in MuJoCo: the numbers stay small wherever the tree is.

pub mod com;
pub mod inertia;
pub mod kinematics;
