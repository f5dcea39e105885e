//! Numbers and small geometry that all kernels use: [`Real`] (one environment or several in parallel), vectors,
//! rotations, and spatial motion and force vectors. This crate has no notion of bodies, joints or contacts.
//!
//! A kernel is written once. A [`LaneTask`] runs it for as many environments in parallel as the processor's registers
//! hold:
//!
//! ```
//! use clench_math::{Instructions, LaneTask, Real, Scalar, kernel};
//!
//! /// Coulomb friction: opposes the velocity, and is zero at rest.
//! #[kernel]
//! fn friction<T: Real>(velocity: &[T], limit: T, force: &mut [T]) {
//!     for (force, &v) in force.iter_mut().zip(velocity) {
//!         *force = T::select(v.eq(T::ZERO), T::ZERO, -limit.copysign(v));
//!     }
//! }
//!
//! /// Friction of environments whose velocities lie in one row.
//! struct Friction<'a> {
//!     velocity: &'a [f64],
//! }
//! impl LaneTask<f64> for Friction<'_> {
//!     type Output = Vec<f64>;
//!     fn run<T: Real<Scalar = f64>>(self) -> Vec<f64> {
//!         let mut velocity = vec![T::ZERO; self.velocity.len().div_ceil(T::LANES)];
//!         T::as_scalars_mut(&mut velocity)[..self.velocity.len()].copy_from_slice(self.velocity);
//!         let mut force = vec![T::ZERO; velocity.len()];
//!         friction(&velocity, T::new(0.5), &mut force);
//!         T::as_scalars(&force)[..self.velocity.len()].to_vec()
//!     }
//! }
//!
//! let velocity = &[1.0, 0.0, -3.0];
//! for instructions in Instructions::all_available::<f64>() {
//!     let force = f64::in_lanes(instructions, Friction { velocity });
//!     assert_eq!(force, Some(vec![-0.5, 0.0, 0.5]));
//! }
//! ```

// Only `lanes` needs unsafe code: it calls instructions after detecting them.
#![deny(unsafe_code)]
#![deny(unreachable_pub)]

// `#[kernel]` refers to this crate by name, also inside it.
extern crate self as clench_math;

mod array;
mod cast;
mod compiled;
mod dual;
mod eigen;
mod elementary;
#[allow(unsafe_code, reason = "registers, and code for one instruction set")]
mod lanes;
mod matrix;
mod quaternion;
mod real;
mod scalar;
mod spatial;
mod vector;

pub use array::array;
pub use cast::{broadcast, cast, read_lane, write_lane};
/// ```
/// # use clench_math::{Real, kernel};
/// #[kernel]
/// pub fn dot<T: Real>(a: &[T], b: &[T]) -> T {
///     let mut sum = T::ZERO;
///     for (&a, &b) in a.iter().zip(b) {
///         sum += a * b;
///     }
///     sum
/// }
/// assert_eq!(dot(&[1.0, 2.0], &[3.0, 4.0]), 11.0);
/// ```
///
pub use clench_kernel::kernel;
pub use compiled::{CompiledKernels, KernelTable};
pub use dual::Dual;
pub use eigen::{principal_axes, rough_principal_axes};
pub use lanes::{Instructions, LaneMask, LaneTask, Lanes, Portable};
pub use matrix::Mat3;
pub use quaternion::Quat;
pub use real::{Clock, Double, Mask, Real, Scalar};
pub use spatial::{Force, Inertia, Motion};
pub use vector::Vec3;
