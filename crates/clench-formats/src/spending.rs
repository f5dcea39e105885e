//! What a model's files have asked for so far, held against their budget.

use clench_rigid::Budget;
use clench_rigid::budget::RAISE;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// A budget and what has been taken from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spending {
    pub budget: Budget,
    bytes: u64,
    elements: u64,
}

impl Spending {
    /// Nothing taken yet.
    pub fn new(budget: Budget) -> Self {
        Spending {
            budget,
            bytes: 0,
            elements: 0,
        }
    }

    /// Takes memory, before it is allocated.
    ///
    /// # Errors
    /// What to say where it is more than is left.
    pub fn bytes(&mut self, count: u64) -> Result<(), String> {
        self.bytes = self.bytes.saturating_add(count);
        let most = self.budget.bytes;
        match self.bytes > most {
            true => Err(format!(
                "up to here the model takes more than {most} bytes; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Takes elements.
    ///
    /// # Errors
    /// What to say where they are more than are left.
    pub fn elements(&mut self, count: u64) -> Result<(), String> {
        self.elements = self.elements.saturating_add(count);
        let most = self.budget.elements;
        match self.elements > most {
            true => Err(format!(
                "up to here the model has more than {most} elements; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Reads a file, and takes its length.
    ///
    /// # Errors
    /// What to say where it cannot be read or is too long.
    pub fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let read = || -> io::Result<Vec<u8>> {
            let left = self.budget.bytes.saturating_sub(self.bytes);
            let mut bytes = Vec::new();
            File::open(path)?
                .take(left.saturating_add(1))
                .read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = read().map_err(|error| error.to_string())?;
        self.bytes(bytes.len() as u64)?;
        Ok(bytes)
    }
}
