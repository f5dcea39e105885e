//! Limits on the resources of one call, so that a short command line or a small file causes an error message instead of
//! exhausting the memory.

use anyhow::{Result, bail, ensure};
use clap::Args;
use std::fmt::Display;

/// The maximum number of steps if none of --steps, --time and --ctrl defines it.
pub const MAX_DEFAULT_STEPS: f64 = 1e6;
/// The maximum number of steps of --time: at a microsecond each they take thirty years.
const MAX_STEPS: f64 = 1e15;
/// The maximum length of the header of an `.npy` file, bytes, as in NumPy.
pub const MAX_NPY_HEADER: usize = 10_000;

/// The heading of the limits in a help text.
pub(crate) const HEADING: &str = "Limits";

/// The number of bytes in a gigabyte.
const GIGABYTE: f64 = 1e9;
/// The default limit of an array file or a record, gigabytes.
const DEFAULT_MEMORY: f64 = 4.0;

/// Returns the number of steps of --time.
pub fn steps_in(time: f64, timestep: f64) -> Result<usize> {
    let steps = (time / timestep).round();
    ensure!(
        steps < MAX_STEPS,
        "--time: {time:e} s in steps of {timestep:e} s are {steps:.3e} steps, more than the maximum of {MAX_STEPS:.0e}"
    );
    Ok(steps as usize)
}

/// The memory limit of arrays.
#[derive(Args)]
pub struct MemoryArguments {
    /// Maximum memory of each input array, and of the record, in gigabytes
    #[arg(long, value_name = "GB", default_value_t = DEFAULT_MEMORY, value_parser = positive, help_heading = HEADING)]
    max_memory: f64,
}

impl MemoryArguments {
    /// Returns the memory limit of one array file or record.
    pub fn limit(&self) -> MemoryLimit {
        MemoryLimit {
            bytes: GIGABYTE * self.max_memory,
        }
    }
}

/// A limit on a number of bytes.
#[derive(Clone, Copy)]
pub struct MemoryLimit {
    bytes: f64,
}

impl Default for MemoryLimit {
    fn default() -> Self {
        MemoryLimit {
            bytes: GIGABYTE * DEFAULT_MEMORY,
        }
    }
}

impl MemoryLimit {
    /// Returns the limit in bytes.
    pub fn bytes(&self) -> usize {
        self.bytes as usize
    }

    /// Checks that `amount` objects of `bytes_each` bytes fit; `what` names them.
    ///
    /// # Errors
    /// Returns an error with the needed and the allowed memory if they do not fit.
    pub fn admit(&self, what: impl Display, amount: u64, bytes_each: usize) -> Result<()> {
        let needed = amount as f64 * bytes_each as f64;
        if needed <= self.bytes {
            return Ok(());
        }
        let (needed, limit) = (needed / GIGABYTE, self.bytes / GIGABYTE);
        let needed = match needed < 0.001 {
            true => format!("{needed:.2e}"),
            false => format!("{needed:.3}"),
        };
        bail!("{what} take {needed} GB, more than the {limit} GB that --max-memory allows")
    }
}

/// Parses a number that must be positive.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        Ok(_) => Err("it must be positive and finite".into()),
        Err(error) => Err(error.to_string()),
    }
}
