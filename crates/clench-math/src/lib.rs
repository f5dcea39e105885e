//! Numbers and small geometry that every kernel shares: [`Real`] (one environment or many side by side),
//! vectors, rotations, and spatial motion and force vectors. Nothing here knows of bodies, joints or contacts.

// `#[kernel]` names this crate; inside it too.
extern crate self as clench_math;

mod array;
mod cast;
mod eigen;
mod elementary;
mod lanes;
mod matrix;
mod quaternion;
mod real;
mod scalar;
mod spatial;
mod vector;

pub use array::array;
pub use cast::{broadcast, cast, read_lane, write_lane};
/// Compiles a numerical function for the instruction set of its number type `T`.
pub use clench_kernel::kernel;
pub use eigen::principal_axes;
pub use lanes::{Instructions, LaneMask, LaneTask, Lanes, Portable};
pub use matrix::Mat3;
pub use quaternion::Quat;
pub use real::{Mask, Real, Scalar};
pub use spatial::{Force, Inertia, Motion};
pub use vector::Vec3;
