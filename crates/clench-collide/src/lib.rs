//! Collision detection: shapes and poses in, contact points out. No joints, no masses.
//!
//! [`collide`] finds the contact points of one pair of shapes, [`listed`] and [`Sweep`] find the pairs worth asking
//! about. Everything is generic over [`Real`](clench_math::Real): one call serves one environment (`f64`) or several
//! side by side, where each contact point says in which of them it exists. Which points a pair yields follows MuJoCo 4.0.

mod broad;
mod contact;
mod frame;
mod narrow;
mod shape;

pub use broad::{Bound, Pair, Sweep, listed, near};
pub use contact::{ContactPoint, Contacts, MAX_POINTS};
pub use frame::{frame_along, frame_from_normal};
pub use narrow::{collide, supported};
pub use shape::{Pose, Shape, ShapeKind, bounding_radius};
