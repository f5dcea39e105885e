//! How much one call may ask of the machine, so that a few words on the command line or a small file end in a message and
//! not in a machine without memory.

use anyhow::{Result, bail, ensure};
use clap::Args;
use std::fmt::Display;

/// The most steps that are taken where neither --steps nor --time nor --ctrl says how many.
pub const MAX_DEFAULT_STEPS: f64 = 1e6;
/// The most steps that --time may mean: at a microsecond each they take thirty years.
const MAX_STEPS: f64 = 1e15;
/// The longest header of an `.npy` file, in bytes: as long as NumPy itself reads one.
pub const MAX_NPY_HEADER: usize = 10_000;

/// Bytes in a gigabyte.
const GIGABYTE: f64 = 1e9;
/// The most gigabytes of an array file or a record where nobody says another number.
const DEFAULT_MEMORY: f64 = 4.0;

/// How many steps --time means.
pub fn steps_in(time: f64, timestep: f64) -> Result<usize> {
    let steps = (time / timestep).round();
    ensure!(
        steps < MAX_STEPS,
        "--time: {time} s in steps of {timestep} s are {steps:.3e} steps, more than the {MAX_STEPS:.0e} that can be taken"
    );
    Ok(steps as usize)
}

/// How much memory arrays may take.
#[derive(Args)]
pub struct MemoryArguments {
    /// Most memory that each array file read, and the record, may take, in gigabytes
    #[arg(long, value_name = "GB", default_value_t = DEFAULT_MEMORY, value_parser = positive)]
    max_memory: f64,
}

impl MemoryArguments {
    /// The most bytes of one array file or record.
    pub fn limit(&self) -> MemoryLimit {
        MemoryLimit {
            bytes: GIGABYTE * self.max_memory,
        }
    }
}

/// A number of bytes that is not to be exceeded.
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
    /// The number.
    pub fn bytes(&self) -> usize {
        self.bytes as usize
    }

    /// Lets `amount` things of so many bytes each pass if they fit; `what` names them.
    ///
    /// # Errors
    /// Things that do not fit: how many bytes they take, and how many may be taken.
    pub fn admit(&self, what: impl Display, amount: u64, bytes_each: usize) -> Result<()> {
        let needed = amount as f64 * bytes_each as f64;
        if needed <= self.bytes {
            return Ok(());
        }
        let (needed, most) = (needed / GIGABYTE, self.bytes / GIGABYTE);
        bail!("{what} take {needed:.3} GB, more than the {most} GB that --max-memory allows")
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        Ok(_) => Err("it must be positive and finite".into()),
        Err(error) => Err(error.to_string()),
    }
}
