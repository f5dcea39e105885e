//! The allocator of the program, which is asked how much a batch takes.

use cap::Cap;
use std::alloc::System;

/// The system's allocator, which also tells how much is allocated: what a batch takes beside its rows is measured.
#[global_allocator]
pub(super) static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);
