//! Environments by the thousand on a graphics device: the step of `clench-rigid`, wholly on the device, in single precision or, where
//! it has that, in double.
//!
//! [`batch`] makes a [`clench_rigid::Batch`] that a device steps, with all that a batch has: rows, resets, snapshots, recorded
//! outputs, queries. [`GpuBatch`] is the device's side of it alone, for those who want nothing to cross the bus unasked. Its kernels (`kernels/*.wgsl`) are sisters of the
//! kernels of `clench-rigid` and `clench-solver`, stage by stage, and tests compare them so. They run on any vendor's card by
//! `wgpu`, and on Mesa's software device where there is none. What a model has that they cannot do yet is an error before the
//! first step. `docs/gpu.md` says how a step is laid out.
//!
//! Here live the kernels, the tables that they read, and the arrays they work on. Physics that the processor does too belongs in the
//! crates below; this one only repeats it.

#![deny(unreachable_pub)]

mod backend;
mod base;
mod batch;
mod check;
mod clock;
mod device;
mod error;
mod fields;
mod kernels;
mod layout;
mod methods;
mod outputs;
mod parameters;
mod pipelines;
mod precision;
mod reports;
mod solver_memory;
mod tables;
mod transfer;

pub use backend::batch;
pub use batch::{GpuBatch, GpuOptions};
pub use device::{DeviceInfo, devices};
pub use error::{GpuError, GpuFault, Refusal};
pub use precision::GpuReal;
pub use reports::GpuSolve;
