//! Thousands of environments on a graphics device: the step of `clench-rigid`, entirely on the device, in single or (if
//! supported) double precision.
//!
//! [`batch`] creates a [`clench_rigid::Batch`] that a device steps, with all features of a batch: rows, resets,
//! snapshots, recorded outputs, queries. [`GpuBatch`] is its device part alone, for users who want no implicit
//! transfers. Its kernels (`kernels/*.wgsl`) are the GPU counterparts of the kernels of the CPU, stage by
//! stage, and tests compare them so. They run on GPUs of any vendor through `wgpu`, and on Mesa's software device where
//! there is none. Unsupported features of a model are errors before the first step. `docs/gpu.md` describes the layout
//! of a step.
//!
//! This crate contains the kernels, the tables that they read, and their arrays. Physics that the processor computes
//! too belongs in the crates below; this one only repeats it.

#![deny(unreachable_pub)]

mod autoreset;
mod backend;
mod base;
mod batch;
mod check;
mod clock;
mod codes;
mod device;
mod error;
mod fields;
mod kernel_options;
mod kernels;
mod layout;
mod methods;
mod outputs;
mod parameters;
mod pipelines;
mod plan;
mod precision;
mod reports;
mod slots;
mod solver_memory;
mod tables;
mod transfer;

pub use backend::batch;
pub use batch::{GpuBatch, GpuOptions};
pub use device::{DeviceInfo, devices};
pub use error::{GpuError, GpuFault, Refusal};
pub use precision::GpuReal;
pub use reports::GpuSolve;
