//! The allocator of the program, which counts the memory of a batch.

use cap::Cap;
use std::alloc::System;

/// The system's allocator with a counter of the allocated bytes, which measures the memory of a batch in addition to
/// its rows.
#[global_allocator]
pub(super) static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);
